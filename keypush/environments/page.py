"""EpisodePage: watches the episodes of an environment in Meshcat."""

from keypush.environments.open_episode import OpenEpisode
from keypush.recording.page import dress_page
from keypush.recording.recorder import make_meshcat
from keypush.recording.scenery import GOAL_COLOUR, add_scenery


class EpisodePage:
    """Shows what runs, live and as a page that plays the episode from its start."""

    def __init__(self) -> None:
        """Starts Meshcat on a port of localhost."""
        self.meshcat = make_meshcat()
        self._running: OpenEpisode | None = None

    @property
    def url(self) -> str:
        """Where a browser can watch."""
        return self.meshcat.web_url()

    def begin(self, running: OpenEpisode) -> None:
        """Records an episode that is at its start."""
        visualizer = running.push.visualizer
        assert visualizer is not None
        visualizer.DeleteRecording()
        visualizer.StartRecording(set_transforms_while_recording=True)
        add_scenery(self.meshcat, running.scenario, running.observe("object_pose")[4:6],
                    running.observe("goal"))  # fmt: skip
        # The frame at time 0 was shown when the simulator was initialised, before the recording.
        running.show()
        self._running = running

    def html(self) -> str | None:
        """Returns the page of the episode so far; None before the first."""
        if self._running is None:
            return None
        self.meshcat.PublishRecording()
        told = self._running.scenario.object.name
        story = [f"keypush/Push-v0, policy step {self._running.steps}"]
        return dress_page(
            self.meshcat.StaticHtml(), f"Pushing the {told}", story, _LEGEND, time_bar=True
        )


_LEGEND = ((GOAL_COLOUR, "goal"),)
