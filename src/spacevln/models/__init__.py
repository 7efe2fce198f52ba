"""Chat models (DESIGN 5.5): endpoints, the relay, replays; retries, prices, the reply cache."""

from spacevln.models.choice import ModelChoice, RetrySettings, choose
from spacevln.models.opening import UNLIMITED, ModelDesk, RunAccess, price_of
from spacevln.models.prices import HourlyPrice, TokenPrice
from spacevln.models.profiles import pairs, profile, profiles
from spacevln.models.recorded import RecordedCall, RecordedModel, ReplayDiverged
from spacevln.models.relay import RelayModel
from spacevln.models.secret import Secret

__all__ = [
    "UNLIMITED",
    "HourlyPrice",
    "ModelChoice",
    "ModelDesk",
    "RecordedCall",
    "RecordedModel",
    "RelayModel",
    "ReplayDiverged",
    "RetrySettings",
    "RunAccess",
    "Secret",
    "TokenPrice",
    "choose",
    "pairs",
    "price_of",
    "profile",
    "profiles",
]
