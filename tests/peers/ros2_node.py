"""A node of ROS 2 over Eclipse Cyclone DDS: a joint trajectory controller, a gripper, joint states and a camera, over an
arm that another program plays.

    ros2_node.py DOMAIN OPTIONS ENGINE...

OPTIONS is JSON: `gripper` is GripperCommand or ParallelGripperCommand, `refuse` refuses trajectories, `ignore` takes
them and does nothing. ENGINE is the command of runtime/arm/examples/arm_engine with its argument. The names, types and
bytes on the wire are those of rmw_cyclonedds_cpp: a service's messages begin with 16 bytes that say whose request
they belong to. Nothing is decided here: goals go to the engine, readings and pictures come from it, and it says which
messages are lost on their way.
"""

import json
import os
import struct
import subprocess
import sys
import time
import types
from dataclasses import dataclass

# This machine alone, which may have no multicast.
os.environ["CYCLONEDDS_URI"] = """<CycloneDDS><Domain><General><Interfaces><NetworkInterface address="127.0.0.1"/>
</Interfaces><AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>
<Peers><Peer address="127.0.0.1"/></Peers></Discovery></Domain></CycloneDDS>"""

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float64, int8, int32, int64, sequence, uint8, uint32, uint64
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

DOMAIN, OPTIONS, COMMAND = int(sys.argv[1]), json.loads(sys.argv[2]), sys.argv[3:]
JOINTS = [f"joint_{joint}" for joint in range(1, 7)]
FINGERS = ["finger_1", "finger_2"]
# How far the clock of the arm's machine is behind, seconds.
BEHIND_S = 1_000_000
ACTIVE, CANCELING = (1, 2, 3), 3
ENDS = {"succeeded": 4, "preempted": 5, "aborted": 6, "rejected": 6}


def message(dds, /, **fields):
    """Declares a message by its type in DDS and its fields."""
    with_fields = lambda namespace: namespace.update(__annotations__=fields)
    return dataclass(types.new_class(dds.split("::")[-1], (IdlStruct,), {"typename": dds}, with_fields))


Time = message("builtin_interfaces::msg::dds_::Time_", sec=int32, nanosec=uint32)
Span = message("builtin_interfaces::msg::dds_::Duration_", sec=int32, nanosec=uint32)
Header = message("std_msgs::msg::dds_::Header_", stamp=Time, frame_id=str)
JointState = message(
    "sensor_msgs::msg::dds_::JointState_", header=Header, name=sequence[str], position=sequence[float64],
    velocity=sequence[float64], effort=sequence[float64],
)
Image = message(
    "sensor_msgs::msg::dds_::Image_", header=Header, height=uint32, width=uint32, encoding=str, is_bigendian=uint8,
    step=uint32, data=sequence[uint8],
)
Region = message(
    "sensor_msgs::msg::dds_::RegionOfInterest_", x_offset=uint32, y_offset=uint32, height=uint32, width=uint32,
    do_rectify=bool,
)
CameraInfo = message(
    "sensor_msgs::msg::dds_::CameraInfo_", header=Header, height=uint32, width=uint32, distortion_model=str,
    d=sequence[float64], k=array[float64, 9], r=array[float64, 9], p=array[float64, 12], binning_x=uint32,
    binning_y=uint32, roi=Region,
)
Uuid = message("unique_identifier_msgs::msg::dds_::UUID_", uuid=array[uint8, 16])
GoalInfo = message("action_msgs::msg::dds_::GoalInfo_", goal_id=Uuid, stamp=Time)
GoalStatus = message("action_msgs::msg::dds_::GoalStatus_", goal_info=GoalInfo, status=int8)
GoalStatusArray = message("action_msgs::msg::dds_::GoalStatusArray_", status_list=sequence[GoalStatus])
Point = message(
    "trajectory_msgs::msg::dds_::JointTrajectoryPoint_", positions=sequence[float64], velocities=sequence[float64],
    accelerations=sequence[float64], effort=sequence[float64], time_from_start=Span,
)
Trajectory = message(
    "trajectory_msgs::msg::dds_::JointTrajectory_", header=Header, joint_names=sequence[str], points=sequence[Point]
)
# Lists of the messages below that stay empty: of these items no byte is ever read.
Vector = message("geometry_msgs::msg::dds_::Vector3_", x=float64, y=float64, z=float64)
MultiPoint = message("trajectory_msgs::msg::dds_::MultiDOFJointTrajectoryPoint_", velocities=sequence[Vector])
MultiTrajectory = message(
    "trajectory_msgs::msg::dds_::MultiDOFJointTrajectory_", header=Header, joint_names=sequence[str],
    points=sequence[MultiPoint],
)
Tolerance = message(
    "control_msgs::msg::dds_::JointTolerance_", name=str, position=float64, velocity=float64, acceleration=float64
)
FollowGoal = message(
    "control_msgs::action::dds_::FollowJointTrajectory_Goal_", trajectory=Trajectory, multi_dof=MultiTrajectory,
    path_tolerance=sequence[Tolerance], component_path=sequence[Tolerance], goal_tolerance=sequence[Tolerance],
    component_goal=sequence[Tolerance], goal_time_tolerance=Span,
)
FollowResult = message(
    "control_msgs::action::dds_::FollowJointTrajectory_Result_", error_code=int32, error_string=str
)
Command = message("control_msgs::msg::dds_::GripperCommand_", position=float64, max_effort=float64)
GripperGoal = message("control_msgs::action::dds_::GripperCommand_Goal_", command=Command)
GripperResult = message(
    "control_msgs::action::dds_::GripperCommand_Result_", position=float64, effort=float64, stalled=bool,
    reached_goal=bool,
)
ParallelGoal = message("control_msgs::action::dds_::ParallelGripperCommand_Goal_", command=JointState)
ParallelResult = message(
    "control_msgs::action::dds_::ParallelGripperCommand_Result_", state=JointState, stalled=bool, reached_goal=bool
)


def now(behind_s=0):
    nanoseconds = time.time_ns() - behind_s * 1_000_000_000
    return Time(nanoseconds // 1_000_000_000, nanoseconds % 1_000_000_000)


def services_qos():
    return Qos(Policy.Reliability.Reliable(duration(milliseconds=100)), Policy.History.KeepLast(10))


class Engine:
    """The program that plays the arm."""

    def __init__(self, command):
        self.program = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def ask(self, ask, **more):
        """Returns the answer, and the bytes that came with it."""
        text = json.dumps({"ask": ask, **more}).encode()
        self.program.stdin.write(struct.pack("<I", len(text)) + text)
        self.program.stdin.flush()
        (length,) = struct.unpack("<I", self.program.stdout.read(4))
        answer = json.loads(self.program.stdout.read(length))
        blobs = [self.program.stdout.read(size) for size in answer["blobs"]]
        if "error" in answer:
            print(f"{ask}: {answer['error']}", file=sys.stderr, flush=True)
        return answer, blobs

    def loses(self, what):
        return self.ask("loses", message=what)[0]["loses"]


class Service:
    """A service, as rmw_cyclonedds_cpp asks and answers: `handle` gets a request and what sends its answer."""

    def __init__(self, participant, name, kind, request, response, handle):
        headed = lambda part, body: message(f"{kind}_{part}_", client=uint64, number=int64, **body)
        self.answer, self.handle = headed("Response", response), handle
        qos = services_qos()
        self.reader = DataReader(participant, Topic(participant, f"rq{name}Request", headed("Request", request)), qos)
        self.writer = DataWriter(participant, Topic(participant, f"rr{name}Reply", self.answer), qos)

    def is_busy(self):
        return False

    def serve(self):
        for asked in self.reader.take(20):
            if not hasattr(asked, "number"):
                continue  # its client has left
            self.handle(
                asked, lambda *said, asked=asked: self.writer.write(self.answer(asked.client, asked.number, *said))
            )


class Action:
    """An action server whose goals the engine carries out; `request` makes its question of a goal, `result` a result."""

    def __init__(self, participant, engine, name, kind, goal, result_type, request, result):
        self.engine, self.request, self.result = engine, request, result
        # The last goals: [id, name at the engine or None, status].
        self.goals, self.waiting = [], []
        kind = f"control_msgs::action::dds_::{kind}"
        service = lambda part, *rest: Service(participant, f"{name}/_action/{part}", *rest)
        self.services = [
            service(
                "send_goal", f"{kind}_SendGoal", {"goal_id": Uuid, "goal": goal}, {"accepted": bool, "stamp": Time},
                self.accept,
            ),
            service(
                "cancel_goal", "action_msgs::srv::dds_::CancelGoal", {"goal_info": GoalInfo},
                {"return_code": int8, "goals_canceling": sequence[GoalInfo]}, self.cancel,
            ),
            service(
                "get_result", f"{kind}_GetResult", {"goal_id": Uuid}, {"status": int8, "result": result_type},
                lambda asked, reply: self.waiting.append((asked, reply)),
            ),
        ]
        qos = Qos(
            Policy.Reliability.Reliable(duration(milliseconds=100)), Policy.History.KeepLast(1),
            Policy.Durability.TransientLocal,
        )
        self.states = DataWriter(participant, Topic(participant, f"rt{name}/_action/status", GoalStatusArray), qos)

    def accept(self, asked, reply):
        if self.engine.loses("goal"):
            return
        question = self.request(asked.goal)
        if question == "refuse":
            return reply(False, now())
        answer = self.engine.ask(**question)[0] if question else {"goal": None}
        if "goal" in answer:
            self.goals = self.goals[-20:] + [[asked.goal_id, answer["goal"], 2]]
            self.tell()
        reply("goal" in answer, now())

    def cancel(self, asked, reply):
        if self.engine.loses("cancel"):
            return
        wanted = asked.goal_info.goal_id.uuid
        found = [goal for goal in self.goals if goal[2] in ACTIVE and (not any(wanted) or goal[0].uuid == wanted)]
        for goal in found:
            if goal[1] is not None:
                self.engine.ask("cancel", goal=goal[1])
            goal[2] = CANCELING if goal[1] is not None else 5
        self.tell()
        reply(0 if found or not any(wanted) else 2, [GoalInfo(goal[0], Time(0, 0)) for goal in found])

    def tell(self):
        self.states.write(GoalStatusArray([GoalStatus(GoalInfo(goal[0], Time(0, 0)), goal[2]) for goal in self.goals]))

    def is_busy(self):
        return any(goal[2] in ACTIVE for goal in self.goals)

    def serve(self):
        for service in self.services:
            service.serve()
        for goal in self.goals:
            if goal[2] in ACTIVE and goal[1] is not None:
                state = self.engine.ask("state", goal=goal[1])[0]["state"]
                if state in ENDS:
                    goal[2] = ENDS[state]
                    self.tell()
        waiting, self.waiting = self.waiting, []
        for asked, reply in waiting:
            status = next((goal[2] for goal in self.goals if goal[0] == asked.goal_id), 0)
            if status in ACTIVE:
                self.waiting.append((asked, reply))
            elif not self.engine.loses("result"):
                reply(status, self.result(status == 4))


def trajectory(goal):
    if OPTIONS.get("refuse"):
        return "refuse"
    if OPTIONS.get("ignore"):
        return None
    order = [goal.trajectory.joint_names.index(name) for name in JOINTS]
    points = goal.trajectory.points
    # joint_trajectory_controller refuses velocities of another count, and a motion at the end.
    assert all(len(point.velocities) == len(JOINTS) for point in points)
    assert all(abs(velocity) < 1.2e-7 for velocity in points[-1].velocities)
    seconds = lambda span: span.sec + span.nanosec * 1e-9

    def values(point):
        return [[each[at] for at in order] for each in (point.positions, point.velocities, point.accelerations)]

    return {
        "ask": "trajectory",
        "points": [(seconds(point.time_from_start), values(point)) for point in points],
    }


def gripper(participant, engine):
    """Returns the gripper's action server."""
    fingers = lambda position: {"ask": "fingers", "positions": [position] * len(FINGERS)}
    if OPTIONS.get("gripper") == "ParallelGripperCommand":
        state = JointState(Header(Time(0, 0), ""), [], [], [], [])

        def positions(goal):
            assert goal.command.name == FINGERS and len(goal.command.position) == len(FINGERS)
            return fingers(goal.command.position[0])

        kind = "ParallelGripperCommand", ParallelGoal, ParallelResult
        return Action(
            participant, engine, "/gripper/gripper_cmd", *kind, positions, lambda done: ParallelResult(state, not done, done)
        )
    kind = "GripperCommand", GripperGoal, GripperResult
    return Action(
        participant, engine, "/gripper/gripper_cmd", *kind, lambda goal: fingers(goal.command.position),
        lambda done: GripperResult(0.0, 0.0, not done, done),
    )


class Publisher:
    """What the arm and the camera say."""

    def __init__(self, participant, engine):
        self.engine = engine
        self.taken_s = self.stamp = None
        best_effort, reliable = Policy.Reliability.BestEffort, Policy.Reliability.Reliable(duration(milliseconds=100))
        writer = lambda name, kind, reliability: DataWriter(
            participant, Topic(participant, "rt" + name, kind), Qos(reliability, Policy.History.KeepLast(2))
        )
        self.joint_states = writer("/joint_states", JointState, best_effort)
        self.color = writer("/camera/color/image_raw", Image, reliable)
        self.depth = writer("/camera/aligned_depth_to_color/image_raw", Image, best_effort)
        self.info = writer("/camera/color/camera_info", CameraInfo, reliable)

    def say(self):
        said, _ = self.engine.ask("readings")
        if said["loses"]:
            return
        if said["taken_s"] != self.taken_s:
            # Another clock than that of whoever listens; an arm that repeats itself repeats its stamp.
            self.taken_s, self.stamp = said["taken_s"], now(BEHIND_S)
        # As joint_state_broadcaster: sorted in no useful way.
        names, positions = FINGERS[::-1] + JOINTS[::-1], said["fingers"][::-1] + said["joints"][::-1]
        self.joint_states.write(JointState(Header(self.stamp, ""), names, positions, [], []))

    def show(self):
        if not self.color.get_matched_subscriptions():
            return
        # Before the picture is taken, so that none claims to be younger than it is.
        header = Header(now(), "camera")
        answer, blobs = self.engine.ask("picture")
        if "error" in answer:
            return
        width, height = answer["size"]
        for topic, encoding, data in (self.color, "rgb8", blobs[0]), (self.depth, "16UC1", blobs[1]):
            topic.write(Image(header, height, width, encoding, 0, len(data) // height, data))
        lens = answer["intrinsics"]
        if lens:
            (fx, fy), (cx, cy) = lens["focal_px"], lens["middle_px"]
            # sensor_msgs counts from the middle of the first pixel.
            k = [fx, 0.0, cx - 0.5, 0.0, fy, cy - 0.5, 0.0, 0.0, 1.0]
            self.info.write(
                CameraInfo(
                    header, height, width, "plumb_bob", lens["distortion"], k, [0.0] * 9, [0.0] * 12, 0, 0,
                    Region(0, 0, 0, 0, False),
                )
            )


def main():
    participant, engine = DomainParticipant(DOMAIN), Engine(COMMAND)
    follow = "FollowJointTrajectory", FollowGoal, FollowResult
    servers = [
        Action(
            participant, engine, "/controller/follow_joint_trajectory", *follow, trajectory,
            lambda done: FollowResult(0 if done else -1, ""),
        ),
        gripper(participant, engine),
        Service(
            participant, "/arm/stop", "std_srvs::srv::dds_::Trigger", {"unused": uint8}, {"success": bool, "message": str},
            lambda asked, reply: (engine.ask("stop"), reply(True, "stopped")),
        ),
    ]
    publisher, said, shown = Publisher(participant, engine), 0.0, 0.0
    while engine.program.poll() is None:
        for server in servers:
            server.serve()
        now_s = time.monotonic()
        if now_s - said >= 0.1:
            said = now_s
            publisher.say()
        # A picture takes the engine so long that the arm would be late; nobody looks while it moves.
        elif now_s - shown >= 0.2 and not any(server.is_busy() for server in servers):
            shown = now_s
            publisher.show()
        time.sleep(0.01)


if __name__ == "__main__":
    main()
