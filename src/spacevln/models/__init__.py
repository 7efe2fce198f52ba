"""Chat models (DESIGN 5.5): endpoints, the relay, replays; retries, prices, the reply cache."""
