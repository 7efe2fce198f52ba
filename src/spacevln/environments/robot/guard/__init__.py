"""The wheel guard: a small process of its own that alone writes velocities, and stops whatever happens to the agent."""
