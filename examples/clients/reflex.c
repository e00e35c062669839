/* A node on rcl alone that turns away from what its lidar sees ahead: one command for each scan.
 *
 *     sh build_reflex.sh PREFIX && ./reflex
 *     python -m harness.run --driver cmd_vel --wait-for-topic /cmd_vel
 *
 * rcl has no parameter services, so --wait-for cannot ask it: --wait-for-topic keeps the lock-step.
 */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>

#include <geometry_msgs/msg/twist_stamped.h>
#include <rcl/error_handling.h>
#include <rcl/rcl.h>
#include <sensor_msgs/msg/laser_scan.h>

static const double AHEAD = 0.5; /* [rad] to either side */
static const double NEAR = 1.5;  /* [m] */
static const int64_t PATIENCE_NS = 100000000;

static volatile sig_atomic_t stopped = 0;

static void stop(int number) {
    (void)number;
    stopped = 1;
}

static void must(rcl_ret_t code, const char *what) {
    if (code != RCL_RET_OK) {
        fprintf(stderr, "reflex: %s: %s\n", what, rcl_get_error_string().str);
        exit(1);
    }
}

static void answer(const sensor_msgs__msg__LaserScan *scan, geometry_msgs__msg__TwistStamped *command) {
    float nearest = INFINITY;
    for (size_t beam = 0; beam < scan->ranges.size; beam++) {
        double angle = (double)scan->angle_min + (double)beam * (double)scan->angle_increment;
        if (fabs(angle) < AHEAD && scan->ranges.data[beam] < nearest) nearest = scan->ranges.data[beam];
    }
    int is_free = nearest > NEAR;
    command->header.stamp = scan->header.stamp; /* says which scan it answers */
    command->twist.linear.x = is_free ? 0.3 : 0.1;
    command->twist.angular.z = is_free ? 0.0 : 0.6;
}

int main(int argc, char **argv) {
    rcl_allocator_t memory = rcl_get_default_allocator();
    rcl_init_options_t options = rcl_get_zero_initialized_init_options();
    rcl_context_t context = rcl_get_zero_initialized_context();
    must(rcl_init_options_init(&options, memory), "options");
    must(rcl_init(argc, (const char *const *)argv, &options, &context), "init");
    signal(SIGINT, stop);
    signal(SIGTERM, stop);

    rcl_node_t node = rcl_get_zero_initialized_node();
    rcl_node_options_t node_options = rcl_node_get_default_options();
    must(rcl_node_init(&node, "reflex", "", &context, &node_options), "node");
    rcl_publisher_t commands = rcl_get_zero_initialized_publisher();
    rcl_publisher_options_t publisher_options = rcl_publisher_get_default_options();
    must(rcl_publisher_init(&commands, &node, ROSIDL_GET_MSG_TYPE_SUPPORT(geometry_msgs, msg, TwistStamped),
                            "cmd_vel", &publisher_options), "cmd_vel");
    rcl_subscription_t scans = rcl_get_zero_initialized_subscription();
    rcl_subscription_options_t subscription_options = rcl_subscription_get_default_options();
    must(rcl_subscription_init(&scans, &node, ROSIDL_GET_MSG_TYPE_SUPPORT(sensor_msgs, msg, LaserScan),
                               "scan", &subscription_options), "scan");

    rcl_wait_set_t waiting = rcl_get_zero_initialized_wait_set();
    must(rcl_wait_set_init(&waiting, 1, 0, 0, 0, 0, 0, &context, memory), "wait set");
    sensor_msgs__msg__LaserScan *scan = sensor_msgs__msg__LaserScan__create();
    geometry_msgs__msg__TwistStamped *command = geometry_msgs__msg__TwistStamped__create();
    while (!stopped) {
        must(rcl_wait_set_clear(&waiting), "wait set");
        must(rcl_wait_set_add_subscription(&waiting, &scans, NULL), "wait set");
        if (rcl_wait(&waiting, PATIENCE_NS) == RCL_RET_TIMEOUT) continue;
        rmw_message_info_t info;
        while (rcl_take(&scans, scan, &info, NULL) == RCL_RET_OK) {
            answer(scan, command);
            must(rcl_publish(&commands, command, NULL), "publish");
        }
        rcl_reset_error(); /* a take that finds nothing leaves a note */
    }
    geometry_msgs__msg__TwistStamped__destroy(command);
    sensor_msgs__msg__LaserScan__destroy(scan);
    must(rcl_wait_set_fini(&waiting), "wait set");
    must(rcl_subscription_fini(&scans, &node), "scan");
    must(rcl_publisher_fini(&commands, &node), "cmd_vel");
    must(rcl_node_fini(&node), "node");
    must(rcl_shutdown(&context), "shutdown");
    must(rcl_context_fini(&context), "context");
    return rcl_init_options_fini(&options) != RCL_RET_OK;
}
