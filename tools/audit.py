"""Looks up known vulnerabilities of everything that the locks pin. Called by `make audit`.

pip-audit asks PyPI or OSV. Where neither answers, nothing can be said: this tells so and ends well, for
a machine without network is no reason to fail. (pip-audit itself would skip every package of a mirror
without advisories, and then report that none has any.)
"""

import json
import subprocess
import sys
import urllib.request
import venv
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LOCKS = (
    "requirements.txt",
    "tools/run.txt",
    "tools/build.txt",
    "tools/jazzy.txt",
    "tools/cluster.txt",
    "tools/clients.txt",
    "tools/audit.txt",
    "tools/docs.txt",
    "tools/release.txt",
)
PINNED = ROOT / "tools/audit.txt"
ENVIRONMENT = ROOT / "build/audit"
READY = ENVIRONMENT / ".ready"
TIMEOUT = 10.0  # [s]
# What each service of pip-audit answers about one package, and a word that this contains.
SERVICES = {
    "pypi": ("https://pypi.org/pypi/pip/9.0.1/json", "vulnerabilities"),
    "osv": ("https://api.osv.dev/v1/vulns/PYSEC-2023-228", "affected"),
}


def main(services: Mapping[str, tuple[str, str]] = SERVICES) -> int:
    """Runs the audit; returns pip-audit's worst exit code, or 0 where no index can be reached."""
    reasons = {}
    for service, (url, word) in services.items():
        reason = unreachable(url, word)
        if reason is None:
            return audit(service)
        reasons[url] = reason
    told = "; ".join(f"{url}: {reason}" for url, reason in reasons.items())
    print(f"audit: NOTHING WAS CHECKED, no index of advisories can be reached ({told})")
    return 0


def unreachable(url: str, word: str) -> str | None:
    """Why a service does not answer as it should; None if it does."""
    try:
        with urllib.request.urlopen(url, timeout=TIMEOUT) as answer:  # noqa: S310 - ours
            found = json.load(answer)
    except (OSError, ValueError) as error:
        return str(error)
    return None if word in found else "an answer without advisories"


def audit(service: str) -> int:
    """Asks one service about what each lock installs on this Python."""
    python = ENVIRONMENT / "bin/python"
    if not READY.exists() or READY.stat().st_mtime < PINNED.stat().st_mtime:
        venv.create(ENVIRONMENT, clear=True, with_pip=True)
        install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--require-hashes"]
        subprocess.run([python, *install, "--requirement", PINNED], check=True)
        READY.touch()
    words = ["--strict", "--disable-pip", "--require-hashes", "--vulnerability-service", service]
    codes = []
    for lock in LOCKS:  # one by one: two locks may pin two versions of one package
        print(f"audit: {lock}", flush=True)
        command = [python, "-m", "pip_audit", *words, "--requirement", ROOT / lock]
        codes.append(subprocess.run(command, check=False).returncode)
    return max(codes)


if __name__ == "__main__":
    sys.exit(main())
