"""Lets OpenAI's own client ask `fabc serve` what `fabc render --out FOLDER` wrote: BASE_URL RENDERED.json FOLDER."""

import base64
import json
import sys

import openai

base_url, rendered, folder = sys.argv[1:]
client = openai.OpenAI(base_url=base_url, api_key="none is needed", max_retries=0)
with open(rendered, encoding="utf-8") as file:
    describe = json.load(file)["stages"][0]

shown = [part for message in describe["messages"] for part in message["parts"] if part["type"] != "text"]
assert len(shown) == 2, "the stage shows two pictures"


def data_url(part):
    number = next(index for index, picture in enumerate(shown, 1) if picture is part)
    with open(f"{folder}/{describe['stage']}_{number}.png", "rb") as picture:
        return "data:image/png;base64," + base64.b64encode(picture.read()).decode()


def chat_part(part):
    if part["type"] == "text":
        return {"type": "text", "text": part["text"]}
    return {"type": "image_url", "image_url": {"url": data_url(part)}}


def response_part(part):
    if part["type"] == "text":
        return {"type": "input_text", "text": part["text"]}
    return {"type": "input_image", "detail": "auto", "image_url": data_url(part)}


def turns(of):
    return [
        {"role": message["role"], "content": [of(part) for part in message["parts"]]}
        for message in describe["messages"]
    ]


def refused(kind, param, ask):
    try:
        ask()
    except kind as error:
        assert error.param == param, error
    else:
        raise AssertionError(f"{param} was not refused")


assert [model.id for model in client.models.list()] == ["geometric"]
assert client.models.retrieve("geometric").owned_by == "fabc"

completion = client.chat.completions.create(
    model="geometric", messages=turns(chat_part), temperature=0.2, max_tokens=1000, seed=4
)
said = completion.choices[0].message.content
assert said.startswith("Instructions: "), said
assert completion.choices[0].finish_reason == "stop"
usage = completion.usage
assert usage.prompt_tokens > 100 and usage.total_tokens == usage.prompt_tokens + usage.completion_tokens, usage

response = client.responses.create(
    model="geometric", input=turns(response_part), temperature=0.2, max_output_tokens=1000, store=False
)
assert response.status == "completed"
assert response.output_text == said, response.output_text
assert response.usage.input_tokens == usage.prompt_tokens

hello = [{"role": "user", "content": "hello"}]
refused(
    openai.BadRequestError,
    "stream",
    lambda: client.chat.completions.create(model="geometric", messages=hello, stream=True),
)
refused(
    openai.NotFoundError,
    "model",
    lambda: client.responses.create(model="gpt-4o", input="hello"),
)
far = [{"role": "user", "content": [{"type": "image_url", "image_url": {"url": "https://example.org/a.png"}}]}]
refused(
    openai.BadRequestError,
    "messages[0].content[0].image_url",
    lambda: client.chat.completions.create(model="geometric", messages=far),
)
