"""RSB: the socket transport of the Robotics Service Bus, in both its roles, without RSB's own libraries."""
