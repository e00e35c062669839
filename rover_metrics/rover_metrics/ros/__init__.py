"""What imports rclpy, apart from metrics_node."""
