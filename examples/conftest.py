"""Makes the fixture `start_trial` known to the tests of this folder."""

pytest_plugins = ["harness.testing.plugin"]
