"""A ROS node with the topics, services and action servers of kinova-ros, over an arm that another program plays.

    arm_node.py MESSAGES MODEL TRAJECTORY ENGINE...

MESSAGES holds the Python modules that ros_messages.py made, MODEL is e.g. j2n6s200, TRAJECTORY the name of a
FollowJointTrajectory server, and ENGINE the command of runtime/examples/arm_engine with its argument. The action servers are actionlib's
own; nothing is decided here: goals and stops go to the engine, its readings and pictures come from it, and it says
which messages are lost on their way.
"""

import json
import struct
import subprocess
import sys
import threading

sys.path.insert(0, sys.argv[1])

import actionlib
import rospy
from control_msgs.msg import FollowJointTrajectoryAction
from geometry_msgs.msg import PoseStamped
from kinova_msgs.msg import ArmPoseAction, FingerPosition, SetFingersPositionAction
from kinova_msgs.srv import Start, StartResponse, Stop, StopResponse
from sensor_msgs.msg import CameraInfo, Image, JointState

# kinova-ros: radians of a finger's joint over units of its position.
FINGER_JOINT = 1.4 / 6400.0


# How far the clock of the arm's machine is behind.
BEHIND = rospy.Duration(1000000)


class Engine:
    """The program that plays the arm."""

    def __init__(self, command):
        self.program = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.lock = threading.Lock()

    def ask(self, ask, **more):
        """Returns the answer, and the bytes that came with it."""
        text = json.dumps({"ask": ask, **more}).encode()
        with self.lock:
            self.program.stdin.write(struct.pack("<I", len(text)) + text)
            self.program.stdin.flush()
            (length,) = struct.unpack("<I", self.program.stdout.read(4))
            answer = json.loads(self.program.stdout.read(length))
            blobs = [self.program.stdout.read(size) for size in answer["blobs"]]
        if "error" in answer:
            rospy.logwarn("%s: %s", ask, answer["error"])
        return answer, blobs

    def loses(self, message):
        return self.ask("loses", message=message)[0]["loses"]

    def unless_lost(self, message, pass_on):
        """Returns what passes messages on, but for those of this kind that are lost."""
        return lambda *what: None if self.loses(message) else pass_on(*what)


class Server:
    """An action server whose goals the engine carries out."""

    def __init__(self, engine, name, action, request):
        self.engine, self.request = engine, request
        self.server = actionlib.SimpleActionServer(name, action, self.execute, auto_start=False)
        # Between the topics and actionlib: a message that is lost was never there for either.
        wire = self.server.action_server
        wire.internal_goal_callback = engine.unless_lost("goal", wire.internal_goal_callback)
        wire.internal_cancel_callback = engine.unless_lost("cancel", wire.internal_cancel_callback)
        self.server.start()
        wire.result_pub.publish = engine.unless_lost("result", wire.result_pub.publish)

    def execute(self, goal):
        answer, _ = self.engine.ask(**self.request(goal))
        if "goal" not in answer:
            self.server.set_aborted()
            return
        rate = rospy.Rate(50)
        while not rospy.is_shutdown():
            if self.server.is_preempt_requested():
                self.engine.ask("cancel", goal=answer["goal"])
            state = self.engine.ask("state", goal=answer["goal"])[0]["state"]
            if state == "succeeded":
                return self.server.set_succeeded()
            if state == "preempted":
                return self.server.set_preempted()
            if state in ("aborted", "rejected"):
                return self.server.set_aborted()
            rate.sleep()


def tool_pose(goal):
    at, turn = goal.pose.pose.position, goal.pose.pose.orientation
    if goal.pose.header.frame_id != sys.argv[2] + "_link_base":
        return {"ask": "state", "goal": "in another frame"}
    return {"ask": "tool_pose", "position": [at.x, at.y, at.z], "turn": [turn.x, turn.y, turn.z, turn.w]}


def fingers(n_fingers):
    return lambda goal: {
        "ask": "fingers",
        "positions": [getattr(goal.fingers, f"finger{finger}") for finger in range(1, n_fingers + 1)],
    }


def trajectory(joints):
    def request(goal):
        order = [goal.trajectory.joint_names.index(name) for name in joints]
        points = goal.trajectory.points
        # kinova-ros's controller moves by the velocities, and reads them without looking.
        assert all(len(point.velocities) == len(joints) for point in points) and len(points) > 1

        def values(point):
            return [[each[at] for at in order] for each in (point.positions, point.velocities, point.accelerations)]

        return {
            "ask": "trajectory",
            "points": [(point.time_from_start.to_sec(), values(point)) for point in points],
        }

    return request


class Publisher:
    """What the arm and the camera say, ten times a second."""

    def __init__(self, engine, model, joints):
        self.engine, self.model, self.joints = engine, model, joints
        self.taken_s = self.stamp = None
        self.tool = rospy.Publisher("~out/tool_pose", PoseStamped, queue_size=2)
        self.joint_state = rospy.Publisher("~out/joint_state", JointState, queue_size=2)
        self.fingers = rospy.Publisher("~out/finger_position", FingerPosition, queue_size=2)
        self.color = rospy.Publisher("/camera/color/image_raw", Image, queue_size=2)
        self.depth = rospy.Publisher("/camera/aligned_depth_to_color/image_raw", Image, queue_size=2)
        self.info = rospy.Publisher("/camera/color/camera_info", CameraInfo, queue_size=2)

    def say(self):
        said, _ = self.engine.ask("readings")
        if said["loses"]:
            return
        if said["taken_s"] != self.taken_s:
            # Another clock than that of whoever listens; an arm that repeats itself repeats its stamp.
            self.taken_s, self.stamp = said["taken_s"], rospy.Time.now() - BEHIND
        now = self.stamp
        pose = PoseStamped()
        pose.header.stamp, pose.header.frame_id = now, self.model + "_link_base"
        at, turn = pose.pose.position, pose.pose.orientation
        at.x, at.y, at.z = said["tool"]["position"]
        turn.x, turn.y, turn.z, turn.w = said["tool"]["turn"]
        self.tool.publish(pose)
        positions = said["fingers"] + [0.0] * (3 - len(said["fingers"]))
        self.fingers.publish(FingerPosition(*positions))
        # As kinova-ros: nine positions, whatever the number of names.
        state = JointState(position=said["joints"] + [FINGER_JOINT * position for position in positions])
        state.header.stamp = now
        state.name = self.joints + [f"{self.model}_joint_finger_{at + 1}" for at in range(len(said["fingers"]))]
        self.joint_state.publish(state)

    def show(self):
        if not self.color.get_num_connections():
            return
        # Before the picture is taken, so that none claims to be younger than it is.
        stamp = rospy.Time.now()
        answer, blobs = self.engine.ask("picture")
        if "error" in answer:
            return
        width, height = answer["size"]
        for topic, encoding, data in (self.color, "rgb8", blobs[0]), (self.depth, "16UC1", blobs[1]):
            image = Image(width=width, height=height, encoding=encoding, data=data, step=len(data) // height)
            image.header.stamp = stamp
            topic.publish(image)
        lens = answer["intrinsics"]
        if lens:
            info = CameraInfo(width=width, height=height, distortion_model="plumb_bob", D=lens["distortion"])
            info.header.stamp = stamp
            (fx, fy), (cx, cy) = lens["focal_px"], lens["middle_px"]
            # sensor_msgs counts from the middle of the first pixel.
            info.K = [fx, 0, cx - 0.5, 0, fy, cy - 0.5, 0, 0, 1]
            self.info.publish(info)


def answer_stop(engine):
    def answer(_):
        if engine.loses("stop"):
            # Longer than anybody waits.
            rospy.sleep(3.0)
            return None
        engine.ask("stop")
        return StopResponse("Arm stopped")

    return answer


def main():
    model, trajectory_server, command = sys.argv[2], sys.argv[3], sys.argv[4:]
    rospy.init_node(model + "_driver")
    engine = Engine(command)
    joints = [f"{model}_joint_{joint}" for joint in range(1, int(model[3]) + 1)]
    Server(engine, "~pose_action/tool_pose", ArmPoseAction, tool_pose)
    Server(engine, "~fingers_action/finger_positions", SetFingersPositionAction, fingers(int(model[5])))
    Server(engine, trajectory_server, FollowJointTrajectoryAction, trajectory(joints))
    answer_start = lambda _: (engine.ask("start"), StartResponse("Arm started"))[1]
    rospy.Service("~in/stop", Stop, answer_stop(engine))
    rospy.Service("~in/start", Start, answer_start)
    publisher = Publisher(engine, model, joints)
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        publisher.say()
        publisher.show()
        rate.sleep()


if __name__ == "__main__":
    main()
