"""Episodes with their truth, metrics, suites, attempts, the runner, summaries. Nothing that the agent could import (DESIGN 5.8)."""
