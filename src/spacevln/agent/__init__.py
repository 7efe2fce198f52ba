"""The agent: the stage loop of Algorithm 1 and what it needs to act, look, plan and end."""

from spacevln.agent.conclusion import Ending, EpisodeResult
from spacevln.agent.loop import NavigationAgent
from spacevln.agent.settings import AgentSettings, Components

__all__ = ["AgentSettings", "Components", "Ending", "EpisodeResult", "NavigationAgent"]
