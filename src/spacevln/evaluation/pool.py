"""Workers that attempt episodes: one environment each, watched, replaced when they die or take too long.

Where they live is a :class:`Workplace`: processes of this machine (:mod:`.processes`) or actors of a Ray cluster
(:mod:`.ray_cluster`).
"""

from __future__ import annotations

import time
from collections import OrderedDict, deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol

from spacevln.core import Detector, EnvironmentFailure, PrerequisiteError, RecordError, SpaceVLNError, SpendingLimit, UsageError

POLL_S = 0.5
END_S = 5.0
"""How long workers may take to end by themselves."""

MAX_FALSE_STARTS = 10
"""Workers in a row that may die before they are ready."""

Attempt = Callable[[str, int], None]
"""Attempts an episode, given its id and how often it was begun before; the result is on the disk when it returns."""


class Opener(Protocol):
    """Opens a worker's environment; a function of a module, because other processes find it by its name."""

    def __call__(self, job: str, detector: Detector | None = None, /) -> AbstractContextManager[Attempt]:
        """Open.

        Args:
            job: what to attempt, in JSON.
            detector: asked instead of one of the worker's own.
        """


CARRIED: dict[str, type[SpaceVLNError]] = {
    error.__name__: error for error in (UsageError, PrerequisiteError, RecordError, SpendingLimit)
}
"""Errors of a worker that end the whole run with their sentence."""


@dataclass(frozen=True, slots=True)
class Message:
    """What a worker says: it is ready, an attempt is over, or an error ends the run.

    Args:
        kind: which of them.
        error, sentence: which one of :data:`CARRIED`, and what it says.
    """

    kind: Literal["ready", "done", "error"]
    error: str = ""
    sentence: str = ""

    @classmethod
    def of(cls, error: SpaceVLNError) -> Message:
        """Carry an error over."""
        return cls("error", next(name for name, kind in CARRIED.items() if isinstance(error, kind)), str(error))


class Queue:
    """Episodes that wait, handed out so that a worker stays in a building.

    Args:
        episodes: (id, building) in order.
    """

    def __init__(self, episodes: Sequence[tuple[str, str]]) -> None:
        self._scene_of = dict(episodes)
        self._waiting: OrderedDict[str, deque[str]] = OrderedDict()
        for name, scene in episodes:
            self._waiting.setdefault(scene, deque()).append(name)

    def __len__(self) -> int:
        return sum(map(len, self._waiting.values()))

    def take(self, scene: str | None = None, taken: Sequence[str | None] = ()) -> str:
        """The next episode: of the same building, else of one where no other worker is, else the first."""
        if scene not in self._waiting:
            scene = next((each for each in self._waiting if each not in taken), next(iter(self._waiting)))
        assert scene is not None  # noqa: S101 - a key of the table
        group = self._waiting[scene]
        name = group.popleft()
        if not group:
            del self._waiting[scene]
        return name

    def again(self, name: str) -> None:
        """Put an episode back, to come next."""
        scene = self._scene_of[name]
        self._waiting.setdefault(scene, deque()).appendleft(name)
        self._waiting.move_to_end(scene, last=False)

    def scene_of(self, name: str) -> str:
        """The building of an episode."""
        return self._scene_of[name]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of an attempt.

    Args:
        episode_id: of what.
        death: how the worker died in it; None when it came back.
    """

    episode_id: str
    death: str | None = None


class Pool(Protocol):
    """Attempts episodes somewhere."""

    def outcomes(self, queue: Queue, begin: Callable[[str], int]) -> Iterator[Outcome]:
        """Attempt everything in the queue, what is put back while this runs included.

        Args:
            queue: what waits.
            begin: called right before an episode is handed out; says how often it was begun before.

        Raises:
            SpaceVLNError: a worker met an error that concerns the whole run.
        """


class WorkerLost(Exception):  # noqa: N818 - an event of the pool, no error of the program
    """A worker is dead or out of reach; the message says how."""


class Worker(Protocol):
    """One environment somewhere, and one attempt at a time in it."""

    def hand_out(self, episode_id: str, before: int) -> None:
        """Begin an attempt; a worker that is dead says so when it is next heard."""

    def heard(self) -> Message | None:
        """What it has said since the last time, without waiting.

        Raises:
            WorkerLost: it will say nothing any more.
        """

    def kill(self) -> None:
        """End it at once."""


class Workplace(Protocol):
    """Where workers live."""

    def start(self, opener: Opener, job: str) -> Any:
        """A new :class:`Worker`."""

    def wait(self, workers: Sequence[Any], timeout_s: float) -> None:
        """Until one of its workers says something, or for a while."""

    def end(self, workers: Sequence[Any]) -> None:
        """Let its workers end within :data:`END_S`, then kill them, and leave."""


@dataclass(slots=True)
class _Post:
    """A worker, and what it is at."""

    worker: Worker
    ready: bool = False
    episode_id: str | None = None
    scene: str | None = None
    begun_s: float = 0.0


@dataclass(slots=True)
class WatchedPool:
    """Workers of one workplace.

    Args:
        workplace: where they live.
        opener, job: what each of them opens.
        size: how many.
        deadline_s: a worker that takes longer for one episode is killed, which counts as its death; None waits for ever.
    """

    workplace: Workplace
    opener: Opener
    job: str
    size: int
    deadline_s: float | None = None
    _false_starts: int = field(default=0, init=False)

    def outcomes(self, queue: Queue, begin: Callable[[str], int]) -> Iterator[Outcome]:
        """See :class:`Pool`."""
        posts: list[_Post] = []
        try:
            while queue or any(post.episode_id is not None for post in posts):
                self._hire(posts, len(queue))
                for post in posts:
                    if post.ready and post.episode_id is None and queue:
                        self._assign(post, queue, [other.scene for other in posts], begin)
                self.workplace.wait([post.worker for post in posts], POLL_S)
                for post in tuple(posts):
                    try:
                        outcome = self._collect(post)
                    except WorkerLost as lost:
                        posts.remove(post)
                        outcome = self._bury(post, str(lost))
                    if outcome is not None:
                        yield outcome
        finally:
            self.workplace.end([post.worker for post in posts])

    def _hire(self, posts: list[_Post], waiting: int) -> None:
        """Start workers while there is work for one more."""
        busy = sum(post.episode_id is not None for post in posts)
        while len(posts) < min(self.size, busy + waiting):
            posts.append(_Post(self.workplace.start(self.opener, self.job)))

    def _bury(self, post: _Post, how: str) -> Outcome | None:
        """What became of a lost worker's attempt; None where it had none."""
        self._false_starts += not post.ready
        if self._false_starts == MAX_FALSE_STARTS:
            raise EnvironmentFailure(
                f"{MAX_FALSE_STARTS} workers in a row died before they were ready, the last one so: {how}; "
                "run with --workers 1 and `spacevln doctor`."
            )
        return None if post.episode_id is None else Outcome(post.episode_id, how)

    def _assign(self, post: _Post, queue: Queue, taken: Sequence[str | None], begin: Callable[[str], int]) -> None:
        post.episode_id = queue.take(post.scene, taken)
        post.scene = queue.scene_of(post.episode_id)
        post.begun_s = time.monotonic()
        post.worker.hand_out(post.episode_id, begin(post.episode_id))

    def _collect(self, post: _Post) -> Outcome | None:
        message = post.worker.heard()
        if message is None:
            late = self.deadline_s is not None and time.monotonic() - post.begun_s > self.deadline_s
            if post.episode_id is not None and late:
                post.worker.kill()
                raise WorkerLost(f"it took longer than {self.deadline_s:g} s")
            return None
        if message.kind == "error":
            raise CARRIED[message.error](message.sentence)
        post.ready = True
        self._false_starts = 0
        if post.episode_id is None:
            return None
        done = Outcome(post.episode_id)
        post.episode_id = None
        return done
