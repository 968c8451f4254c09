"""Makes Python modules from the definitions of ROS messages, and tells their MD5 sums.

    ros_messages.py DEFINITIONS OUT            writes a module for each package that Debian does not have
    ros_messages.py DEFINITIONS OUT TYPE...    then prints `TYPE SUM` for each message or service

Runs with Debian's Python, whose genpy is the generator of ROS itself. An action becomes the seven messages that
actionlib's own generator would make of it.
"""

import importlib
import subprocess
import sys
from pathlib import Path

# What Debian has no Python modules for.
PACKAGES = ["control_msgs", "kinova_msgs"]
INCLUDED = ["std_msgs", "geometry_msgs", "actionlib_msgs", "trajectory_msgs"]


def messages_of(action):
    """Returns the messages of an action file, by name."""
    name = action.stem
    goal, result, feedback = action.read_text().split("---\n")
    header = "Header header\n"
    return {
        f"{name}Goal": goal,
        f"{name}Result": result,
        f"{name}Feedback": feedback,
        f"{name}ActionGoal": f"{header}actionlib_msgs/GoalID goal_id\n{name}Goal goal\n",
        f"{name}ActionResult": f"{header}actionlib_msgs/GoalStatus status\n{name}Result result\n",
        f"{name}ActionFeedback": f"{header}actionlib_msgs/GoalStatus status\n{name}Feedback feedback\n",
        f"{name}Action": f"{name}ActionGoal action_goal\n{name}ActionResult action_result\n"
        f"{name}ActionFeedback action_feedback\n",
    }


def generate(package, definitions, out):
    """Writes the Python package of a ROS package."""
    sources = out / "definitions" / package
    (out / package).mkdir(parents=True)
    (out / package / "__init__.py").touch()
    sources.mkdir(parents=True)
    for message in (definitions / package / "msg").glob("*.msg"):
        (sources / message.name).write_bytes(message.read_bytes())
    for action in (definitions / package / "action").glob("*.action"):
        for name, text in messages_of(action).items():
            (sources / f"{name}.msg").write_text(text)
    services = sorted((definitions / package / "srv").glob("*.srv"))
    places = [f"-I{package}:{sources}"] + [f"-I{name}:/usr/share/{name}/msg" for name in INCLUDED]
    run = lambda *arguments: subprocess.run([sys.executable, *map(str, arguments)], check=True)
    for kind, files in ("msg", sorted(sources.glob("*.msg"))), ("srv", services):
        if files:
            target = out / package / kind
            generator = f"/usr/lib/genpy/gen{kind}_py.py"
            run(generator, "-p", package, "-o", target, *places, *files)
            run(generator, "--initpy", "-p", package, "-o", target)


def sum_of(name):
    """Returns the MD5 sum by which ROS knows a message or service."""
    package, short = name.split("/")
    for kind in "msg", "srv":
        try:
            found = getattr(importlib.import_module(f"{package}.{kind}"), short, None)
        except ModuleNotFoundError:
            continue
        if found:
            return found._md5sum
    return "unknown"


if __name__ == "__main__":
    definitions, out, *types = sys.argv[1:]
    for package in PACKAGES:
        if not (Path(out) / package).exists():
            generate(package, Path(definitions), Path(out))
    sys.path.insert(0, out)
    for name in types:
        print(name, sum_of(name))
