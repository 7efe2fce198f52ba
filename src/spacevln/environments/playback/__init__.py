"""Recorded posed RGB-D: a log of our own, ROS 2 bags, and the environment that plays them."""
