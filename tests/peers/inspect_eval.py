"""Lets Inspect AI, an evaluator by others, put what `fabc render --out FOLDER` wrote to `fabc serve`: BASE_URL
RENDERED.json FOLDER.

It asks through both of OpenAI's interfaces, whole and streamed, and its log has to hold the answers.
"""

import base64
import json
import sys

from inspect_ai import Task, eval
from inspect_ai.dataset import Sample
from inspect_ai.log import read_eval_log
from inspect_ai.model import ChatMessageSystem, ChatMessageUser, ContentImage, ContentText, get_model
from inspect_ai.scorer import includes

base_url, rendered, folder = sys.argv[1:]
with open(rendered, encoding="utf-8") as file:
    describe = json.load(file)["stages"][0]


def asked():
    """The messages of the first stage, which shows two pictures of the cloth."""
    number = 0
    for message in describe["messages"]:
        content = []
        for part in message["parts"]:
            if part["type"] == "text":
                content.append(ContentText(text=part["text"]))
                continue
            number += 1
            with open(f"{folder}/{describe['stage']}_{number}.png", "rb") as picture:
                url = "data:image/png;base64," + base64.b64encode(picture.read()).decode()
            content.append(ContentImage(image=url))
        kind = ChatMessageSystem if message["role"] == "system" else ChatMessageUser
        yield kind(content=content)
    assert number == 2, "the stage shows two pictures"


samples = [
    Sample(id="pictures", input=list(asked()), target="Instructions: "),
    Sample(id="words", input="Where are the corners of the cloth?", target="I cannot choose points"),
]
task = Task(dataset=samples, scorer=includes(), name="cloth")
for responses_api, stream in [(False, False), (False, True), (True, False), (True, True)]:
    model = get_model(
        "openai-api/fabc/geometric",
        base_url=base_url,
        api_key="none is needed",
        responses_api=responses_api,
        stream=stream,
    )
    [finished] = eval(task, model=model, log_dir="logs", max_tokens=500, temperature=0.2, display="none", epochs=2)
    log = read_eval_log(finished.location)
    assert log.status == "success", log.error.message
    assert len(log.samples) == 4, log.samples
    for sample in log.samples:
        wanted = next(it.target for it in samples if it.id == sample.id)
        assert wanted in sample.output.completion, sample.output
        assert sample.output.stop_reason == "stop", sample.output
        assert sample.output.usage.output_tokens > 0, sample.output
    assert log.results.scores[0].metrics["accuracy"].value == 1.0, log.results
