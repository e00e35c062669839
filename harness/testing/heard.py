"""What a test has heard on a topic."""

from typing import Generic, TypeVar

Message = TypeVar("Message")


class Heard(Generic[Message]):
    """The messages of one topic, in the order in which they arrived.

    Attributes:
        topic: Its resolved name.
        messages: All of them.
        times: Simulated seconds at which each arrived.
    """

    def __init__(self, topic: str) -> None:
        self.topic = topic
        self.messages: list[Message] = []
        self.times: list[float] = []

    def __len__(self) -> int:
        return len(self.messages)

    @property
    def latest(self) -> Message:
        """The last message.

        Raises:
            AssertionError: Nothing has been heard.
        """
        if not self.messages:
            message = f"nothing has been heard on {self.topic}"
            raise AssertionError(message)
        return self.messages[-1]

    def take(self, message: Message, time: float) -> None:
        """Adds a message that has just arrived."""
        self.messages.append(message)
        self.times.append(time)
