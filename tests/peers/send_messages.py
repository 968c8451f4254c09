"""Lets OpenAI's own client and Inspect AI, an evaluator by others, send what `fabc render --out FOLDER` wrote: BASE_URL
RENDERED.json FOLDER.

Each sends the first stage once, through Chat Completions. Who listens compares the bodies with that of fabc. Inspect's log
has to hold the answer.
"""

import base64
import json
import sys

import openai
from inspect_ai import Task, eval
from inspect_ai.dataset import Sample
from inspect_ai.log import read_eval_log
from inspect_ai.model import ChatMessageSystem, ChatMessageUser, ContentImage, ContentText, get_model
from inspect_ai.scorer import includes

base_url, rendered, folder = sys.argv[1:]
with open(rendered, encoding="utf-8") as file:
    stage = json.load(file)["stages"][0]

# Each message's role, and its texts and pictures: the latter as `data:` URLs.
turns = []
n_pictures = 0
for message in stage["messages"]:
    parts = []
    for part in message["parts"]:
        if part["type"] == "text":
            parts.append(("text", part["text"]))
            continue
        n_pictures += 1
        with open(f"{folder}/{stage['stage']}_{n_pictures}.png", "rb") as picture:
            parts.append(("image", "data:image/png;base64," + base64.b64encode(picture.read()).decode()))
    turns.append((message["role"], parts))
assert n_pictures == 2, "the stage shows two pictures"


def chat_part(kind, value):
    return {"type": "text", "text": value} if kind == "text" else {"type": "image_url", "image_url": {"url": value}}


client = openai.OpenAI(base_url=base_url, api_key="none is needed", max_retries=0)
messages = [{"role": role, "content": [chat_part(*part) for part in parts]} for role, parts in turns]
completion = client.chat.completions.create(model="geometric", messages=messages)
answer = completion.choices[0].message.content
assert answer.startswith("Instructions: "), answer


def inspect_part(kind, value):
    return ContentText(text=value) if kind == "text" else ContentImage(image=value)


kinds = {"system": ChatMessageSystem, "user": ChatMessageUser}
asked = [kinds[role](content=[inspect_part(*part) for part in parts]) for role, parts in turns]
task = Task(dataset=[Sample(id="first", input=asked, target="Instructions: ")], scorer=includes(), name="cloth")
model = get_model("openai-api/fabc/geometric", base_url=base_url, api_key="none is needed")
[finished] = eval(task, model=model, log_dir="logs", display="none")
log = read_eval_log(finished.location)
assert log.status == "success", log.error.message
[sample] = log.samples
assert sample.output.completion == answer, sample.output
