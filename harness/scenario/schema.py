"""The JSON schema of scenarios, for editors; `python -m harness.scenario.schema` prints it."""

import json
import sys

from harness.scenario.spec import Scenario


def schema() -> str:
    """Returns the schema of scenario files as JSON text."""
    return json.dumps(Scenario.model_json_schema(), indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    sys.stdout.write(schema())
