"""Nodes in other processes, as the services that they answer with: their clients stand in for them."""

import json
import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
from rclpy.task import Future

from harness.ros import remote
from harness.ros.remote import RemoteNode


class Rig:
    """A bridge with one topic, and nodes that answer one second after they are asked."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.found = self.sim_time = self.is_metrics_node = True
        self.promise = ""
        self.silent = ""  # the service that does not answer
        self.lost = 0  # answers that are lost on their way
        self.received: dict[str, int] = {"/scan": 3, "/stranger": 9}
        self.asked: list[str] = []
        self.patience: list[float] = []
        self.came_true: list[bool] = []
        self.matched = 0
        self.now = 0.0
        self.readers: list[tuple[str, str]] = []  # of /scan: namespace and name
        self.listens_anew, self.epoch = False, 0  # of the readers: others with each
        self._waiting: list[tuple[Any, object]] = []
        scan = SimpleNamespace(get_subscription_count=lambda: self.matched)
        self.scan: Any = SimpleNamespace(topic="/scan", publisher=scan, size=0)
        self.bridge: Any = SimpleNamespace(
            time_ns=0,
            get_namespace=lambda: "/rover1/",
            create_client=self._client,
            executor=SimpleNamespace(),
            clock_channel=SimpleNamespace(topic="/clock", size=0),
            channels=[self.scan],
            count_subscribers={"/scan": 2}.get,
            published=lambda: {"/scan": 9, "/imu/data": 9},
            get_fully_qualified_name=lambda: "/rover1/harness",
            get_fully_qualified_node_names=lambda: ["/rover1/harness", "/rviz", "/rover1/nav"],
            get_subscriptions_info_by_topic=lambda _: [
                SimpleNamespace(node_namespace=space, node_name=name, endpoint_gid=[self.epoch])
                for space, name in self.readers
            ],
        )
        monkeypatch.setattr(remote, "spin_until", self._spin_until)
        monkeypatch.setattr(time, "monotonic", lambda: self.now)

    def _spin_until(self, _: object, condition: Callable[[], bool], patience: float) -> bool:
        self.patience.append(patience)
        if not condition():
            self.matched += 2
            self.now += 1.0
            self.answer()
        self.came_true.append(condition())
        return self.came_true[-1]

    def answer(self) -> None:
        """What was asked is answered, as when a run serves its executor."""
        waiting, self._waiting = self._waiting, []
        for future, answer in waiting:
            future.set_result(answer)

    def _client(self, _: type, name: str) -> Any:  # noqa: ANN401 - a client
        def call_async(request: Any) -> Any:  # noqa: ANN401
            data = getattr(request, "data", None)
            self.asked.append(name if data is None else f"{name} {data}")
            self.epoch += self.listens_anew and name.endswith("lock_step")
            future: Any = Future()
            answer = SimpleNamespace(
                values=[SimpleNamespace(bool_value=self.sim_time)],
                message=self.promise if name.endswith("lock_step") else json.dumps(self.received),
            )
            if self.lost:
                self.lost -= 1
            elif name != self.silent:
                self._waiting.append((future, answer))
            return future

        def is_ready() -> bool:
            return self.found if name.endswith("/get_parameters") else self.is_metrics_node

        return SimpleNamespace(service_is_ready=is_ready, call_async=call_async)

    def node(self, name: str = "metrics_node", *, time_jumps: bool = False) -> RemoteNode:
        return RemoteNode(name, self.bridge, time_jumps=time_jumps)

    def asked_now(self) -> list[str]:
        """Which nodes have been asked for their barrier since the last look."""
        asked, self.asked = self.asked, []
        return [name.removesuffix("/get_parameters") for name in asked]
