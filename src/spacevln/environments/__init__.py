"""Worlds: embedded houses; later Habitat-Sim, ROS 2, playback. Independent of each other."""
