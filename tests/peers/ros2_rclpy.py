"""A node of ROS 2 itself, over its default middleware: an action server and the joints' states.

    ros2_rclpy.py

The action `/count` of the type test_msgs/Fibonacci, because control_msgs cannot be had as a wheel: it refuses a negative
order, reaches one below 100, and goes on with any other until it is cancelled.
"""

import time

import rclpy
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import JointState
from test_msgs.action import Fibonacci


class Arm(Node):
    def __init__(self):
        super().__init__("arm")
        self.server = ActionServer(
            self, Fibonacci, "/count", self.execute, callback_group=ReentrantCallbackGroup(),
            goal_callback=lambda goal: GoalResponse.ACCEPT if goal.order >= 0 else GoalResponse.REJECT,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )
        self.states = self.create_publisher(JointState, "/joint_states", qos_profile_sensor_data)
        self.create_timer(0.05, self.say)

    def say(self):
        message = JointState(name=["finger", *(f"joint_{at}" for at in range(6, 0, -1))])
        message.position = [0.5, 1.3, 1.4, 4.2, 1.0, 2.9, 4.8]
        message.header.stamp = self.get_clock().now().to_msg()
        self.states.publish(message)

    def execute(self, goal):
        while goal.request.order >= 100:
            if goal.is_cancel_requested:
                goal.canceled()
                return Fibonacci.Result()
            time.sleep(0.02)
        goal.succeed()
        return Fibonacci.Result(sequence=list(range(goal.request.order)))


rclpy.init()
executor = MultiThreadedExecutor()
executor.add_node(Arm())
executor.spin()
