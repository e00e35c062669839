"""The command harness.call against a node that runs."""

import threading
from collections.abc import Iterator

import pytest

rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import SingleThreadedExecutor
from std_srvs.srv import Empty, SetBool, Trigger

from harness import call
from tests.support.waiting import wait_until

# What a busy machine lets rclpy say of a client that it has not found yet.
pytestmark = pytest.mark.filterwarnings("ignore:failed to send response")


@pytest.fixture
def _services(ros_domain: int) -> Iterator[None]:
    """Services that answer, and one of a type that nobody can call."""
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=ros_domain)
    node = rclpy.create_node("server", context=context)

    def told(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        response.success, response.message = request.data, f"told {request.data}"
        return response

    def asked(_: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.success, response.message = True, "asked"
        return response

    node.create_service(SetBool, "switch", told)
    node.create_service(Trigger, "ask", asked)
    node.create_service(Empty, "clear", lambda _, response: response)
    node.declare_parameter("speed", 1.0)
    node.declare_parameter("names", ["nobody"])
    node.add_on_set_parameters_callback(
        lambda given: SetParametersResult(
            successful=all(p.name != "speed" or p.value >= 0.0 for p in given), reason="too slow"
        )
    )
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    yield
    executor.shutdown()
    thread.join()
    node.destroy_node()
    context.shutdown()


@pytest.mark.usefixtures("_services")
def test_services_are_listed_and_called(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    kinds = {"/ask": "Trigger", "/clear": "Empty", "/switch": "SetBool"}
    listed = "".join(f"{name}  std_srvs/srv/{kind}\n" for name, kind in kinds.items())
    for words, code, out, err in (
        ((), 0, listed, ""),
        (("ask",), 0, "asked\n", ""),
        (("/clear",), 0, "done\n", ""),
        (("/switch", "true"), 0, "told True\n", ""),
        (("/switch", "false"), 1, "told False\n", ""),
        (("/switch",), 2, "", "/switch asks true or false: python -m harness.call /switch true"),
        (("/ask", "true"), 2, "", "/ask asks nothing; leave out 'true'"),
    ):
        assert call.main(words) == code
        expected = f"harness.call: {err}\n" if err else ""
        assert capfd.readouterr() == (out, expected)
    monkeypatch.setattr(call, "_find", lambda *_: dict.fromkeys(kinds, ""))
    assert call.main(["/nope"]) == 2
    told = "there is no service /nope; available: /ask, /clear, /switch\n"
    assert capfd.readouterr() == ("", f"harness.call: {told}")


@pytest.mark.usefixtures("_services")
def test_a_parameter_is_set_as_the_type_that_it_has(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    for words, code, out, err in (
        (("server", "set", "speed", "2"), 0, "/server speed is 2.0\n", ""),
        (("/server", "set", "names", "a,b"), 0, "/server names is ['a', 'b']\n", ""),
        (("/server", "set", "speed", "-1"), 1, "", "/server refuses speed -1: too slow"),
        (("/server", "set", "speed", "fast"), 2, "", "speed 'fast' is not valid; give a number"),
        (("/server", "set", "sped", "2"), 2, "", "'sped'"),
        (("/server", "set", "speed"), 2, "", "give /server set PARAM VALUE"),
        (("/ask", "true", "2"), 2, "", "NODE set PARAM VALUE"),
    ):
        assert call.main(words) == code
        said = capfd.readouterr()
        assert said.out == out
        assert err in said.err
    monkeypatch.setattr(call, "PATIENCE", 0.5)

    def others_are_told() -> bool:
        assert call.main(["/nobody", "set", "speed", "2"]) == 2
        return "node /nobody was not found; running: /server" in capfd.readouterr().err

    wait_until(others_are_told)


def test_where_nothing_runs_it_says_so(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(call, "PATIENCE", 0.0)
    assert call.main([]) == 1
    assert capfd.readouterr().err.startswith("harness.call: no services: does anything run with")
