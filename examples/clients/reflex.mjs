// A node of rclnodejs that turns away from what its lidar sees ahead: one command for each scan.
//
//     node reflex.mjs --ros-args -p use_sim_time:=true
//     python -m harness.run --driver cmd_vel --wait-for /reflex --wait-for-topic /cmd_vel
import rclnodejs from 'rclnodejs';

const AHEAD = 0.5; // [rad] to either side
const NEAR = 1.5; // [m]

await rclnodejs.init();
const node = rclnodejs.createNode('reflex');
const commands = node.createPublisher('geometry_msgs/msg/TwistStamped', 'cmd_vel');
const command = new (rclnodejs.require('geometry_msgs/msg/TwistStamped'))();

node.createSubscription('sensor_msgs/msg/LaserScan', 'scan', (scan) => {
  let nearest = Infinity;
  scan.ranges.forEach((range, beam) => {
    if (Math.abs(scan.angle_min + beam * scan.angle_increment) < AHEAD && range < nearest) nearest = range;
  });
  const isFree = nearest > NEAR;
  command.header.stamp = scan.header.stamp; // says which scan it answers
  command.twist.linear.x = isFree ? 0.3 : 0.1;
  command.twist.angular.z = isFree ? 0.0 : 0.6;
  commands.publish(command);
});

rclnodejs.spin(node);
