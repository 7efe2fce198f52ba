"""Episodes with their truth, metrics, suites, attempts, the runner, summaries (DESIGN 5.8). The agent cannot import any of it."""
