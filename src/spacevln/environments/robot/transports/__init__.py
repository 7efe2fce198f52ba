"""What carries messages: in-process loopback, CycloneDDS, Zenoh, rclpy."""
