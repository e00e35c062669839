"""What a page has beside the scene: what the rover does, how the run goes on, who drives."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import viser

from harness.episode.helm import Helm
from harness.spec.run import Run
from harness.view.live.charts import Charts
from harness.view.live.keys import DIRECTIONS
from harness.view.live.stage import Stage
from harness.view.live.watch import Watch
from harness.view.live.wheel import Wheel
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS, THRESHOLD_INFO, Thresholds

if TYPE_CHECKING:
    from harness.view.live.recording import Player

RATES: dict[str, float | None] = {
    **{f"{rate:g}x": rate for rate in (0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0)},
    "as fast as it can": None,
}
HOW_TO_DRIVE = """Hold **I** or **K** to drive forwards or backwards, **J** or **L** to turn.
**Shift-click** the ground to send it there."""
TIME_STEP = 0.05  # [s]
OF_DEFAULT, PARTS = 4.0, 80  # how far a slider of a threshold goes, and in how many steps


class Panel:
    """The panel of a page.

    Args:
        server: Of the page.
        run: What is shown.
        helm: Gets what is ordered.
        stage: The scene.
        watches: What is seen of each rover.
        steered: Whether rovers take orders, and there is a log with thresholds.
        player: Of a recording; None for a run that goes on.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        run: Run,
        helm: Helm,
        stage: Stage,
        watches: Sequence[Watch],
        *,
        steered: bool,
        player: "Player | None",
    ) -> None:
        self._run, self._helm, self._stage, self._watches = run, helm, stage, watches
        self._gui = gui = server.gui
        self._wheels = [Wheel(helm, number, rover) for number, rover in enumerate(run.rovers)]
        self._rover = 0  # that is looked at and driven
        self._state = gui.add_markdown("")
        self._slider = None if player is None else self._add_time(player)
        self._length = run.duration if player is None else player.end_s
        self._charts: Charts | None = None
        self._sliders: dict[str, viser.GuiSliderHandle[float]] = {}
        self._judged: Thresholds | None = None  # what the sliders show
        if not steered:
            self._add_pace(steered=False)
            self._add_view()
            return
        tabs = gui.add_tab_group()
        with tabs.add_tab("Run"):
            self._add_pace(steered=True)
            self._add_view()
            self._add_driving()
        self._charts = Charts(gui, tabs.add_tab("Charts"))
        with tabs.add_tab("Thresholds"):
            self._add_thresholds()
        server.scene.on_click(modifier="shift")(self._click)

    def show(self) -> None:
        """Shows what the rover does now."""
        watch = self._watches[self._rover]
        truth, rover = watch.truth, self._run.rovers[self._rover]
        name = f"{rover.name}, a {rover.robot}" if rover.name else rover.robot
        self._state.content = (
            f"**{name}** on **{self._run.world.terrain}**\n\n"
            f"**{watch.time_s:.1f} s** of {self._length:g} s"
            + (f", {truth.path_length:.1f} m, {watch.speed:.2f} m/s" if self._charts else "")
        )
        if self._charts is not None:
            self._charts.show(watch)
        if self._helm.metered and (now := self._helm.thresholds(self._rover)) != self._judged:
            self._judged = now
            for name, slider in self._sliders.items():
                slider.value = getattr(now, name)  # type: ignore[misc] # it has a setter
        if self._slider is not None:
            self._slider.value = watch.time_s  # type: ignore[misc] # it has a setter

    def let_go(self) -> None:
        """Stops rovers whose keys nobody holds any more."""
        for wheel in self._wheels:
            wheel.let_go()

    def _add_time(self, player: "Player") -> viser.GuiSliderHandle[float]:
        slider = self._gui.add_slider("Time [s]", 0.0, player.end_s, TIME_STEP, 0.0)

        def seek(event: viser.GuiEvent[viser.GuiSliderHandle[float]]) -> None:
            if event.client is not None:  # else it follows the time
                player.seek(slider.value)

        slider.on_update(seek)
        return slider

    def _add_pace(self, *, steered: bool) -> None:
        gui, helm = self._gui, self._helm
        with gui.add_folder("Run"):
            self._pause = gui.add_button("Pause", icon=viser.Icon.PLAYER_PAUSE)
            step = gui.add_button("Step", icon=viser.Icon.PLAYER_SKIP_FORWARD, hint="0.05 s")
            reset = gui.add_button(
                "Reset", icon=viser.Icon.REFRESH, hint="the rover, to its start", visible=steered
            )
            rates = RATES if helm.rate in RATES.values() else RATES | {f"{helm.rate:g}x": helm.rate}
            now = next(name for name, rate in rates.items() if rate == helm.rate)
            speed = gui.add_dropdown("Speed", tuple(rates), initial_value=now)
        self._pause.on_click(lambda _: self._set_paused(not helm.paused))
        step.on_click(lambda _: self._step())
        reset.on_click(lambda _: self._wheel.reset())
        speed.on_update(lambda _: setattr(helm, "rate", rates[speed.value]))
        gui.add_command("Pause or go on", hotkey="space").on_trigger(
            lambda _: self._set_paused(not helm.paused)
        )
        gui.add_command("Step", hotkey="N").on_trigger(lambda _: self._step())

    def _add_view(self) -> None:
        gui = self._gui
        with gui.add_folder("View"):
            names = [rover.name for rover in self._run.rovers]
            if len(names) > 1:
                rover = gui.add_dropdown("Rover", tuple(names))
                rover.on_update(lambda _: self._choose(names.index(rover.value)))
            self._follow = gui.add_checkbox("Follow the rover", True)
            lidar = gui.add_checkbox("Show what the lidar hits", True)
        self._follow.on_update(lambda _: self._choose(self._rover))
        lidar.on_update(lambda _: self._stage.show_lidar(lidar.value))

    def _add_driving(self) -> None:
        gui = self._gui
        with gui.add_folder("Drive"):
            gui.add_markdown(HOW_TO_DRIVE)
            back = gui.add_button("Let it drive by itself", icon=viser.Icon.STEERING_WHEEL)
        back.on_click(lambda _: self._wheel.give_back())
        for key, (where, forward, left) in DIRECTIONS.items():
            command = gui.add_command(f"Drive {where}", hotkey=key)  # type: ignore[arg-type] # a key it has
            command.on_trigger(partial(self._press, forward, left))

    def _add_thresholds(self) -> None:
        for name, parameter in THRESHOLD_INFO.items():
            default, title = getattr(DEFAULT_THRESHOLDS, name), f"{name} [{parameter.unit}]"
            most = min(OF_DEFAULT * default, parameter.maximum)
            hint = parameter.description
            slider = self._gui.add_slider(title, 0.0, most, most / PARTS, default, hint=hint)
            slider.on_update(partial(self._judge, name, slider))
            self._sliders[name] = slider

    @property
    def _wheel(self) -> Wheel:
        return self._wheels[self._rover]

    def _step(self) -> None:
        self._set_paused(True)
        self._helm.step()

    def _set_paused(self, paused: bool) -> None:
        self._helm.paused = paused
        self._pause.label = "Go on" if paused else "Pause"
        self._pause.icon = viser.Icon.PLAYER_PLAY if paused else viser.Icon.PLAYER_PAUSE

    def _choose(self, rover: int) -> None:
        self._rover = rover
        self._stage.following = rover if self._follow.value else None
        self._stage.draw(self._watches)  # also while the run is paused and nothing moves

    def _press(self, forward: float, left: float, _: viser.CommandEvent) -> None:
        self._wheel.press(forward, left)

    def _judge(
        self,
        name: str,
        slider: viser.GuiSliderHandle[float],
        event: viser.GuiEvent[viser.GuiSliderHandle[float]],
    ) -> None:
        if self._helm.metered and event.client is not None:  # else it follows what holds
            before = self._helm.thresholds(self._rover)
            self._helm.judge(self._rover, replace(before, **{name: slider.value}))

    def _click(self, event: viser.SceneClickEvent) -> None:
        place = self._stage.under(event.ray_origin, event.ray_direction)
        sight = self._watches[self._rover].sight
        if place is not None and sight is not None:
            x, y, _ = place.tolist()
            self._stage.mark(self._wheel.head_for(x, y, sight.position))
