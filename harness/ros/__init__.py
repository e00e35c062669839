"""The only place on this side that imports rclpy: bridge, messages, lock-step."""
