"""Lets OpenAI's own client ask `fabc serve` what `fabc render --out FOLDER` wrote: BASE_URL RENDERED.json FOLDER.

Each question is put by the synchronous and by the asynchronous client, through both interfaces, whole and streamed.
"""

import asyncio
import base64
import io
import json
import sys
from inspect import isawaitable
from typing import Literal

import openai
import PIL.Image
import pydantic

base_url, rendered, folder = sys.argv[1:]
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


def jpeg_url(part):
    png = base64.b64decode(data_url(part).partition(",")[2])
    jpeg = io.BytesIO()
    PIL.Image.open(io.BytesIO(png)).save(jpeg, "JPEG", quality=100)
    return "data:image/jpeg;base64," + base64.b64encode(jpeg.getvalue()).decode()


async def done(result):
    """Waits for the asynchronous client; the other one's result is there already."""
    return await result if isawaitable(result) else result


async def every(events):
    if hasattr(events, "__aiter__"):
        return [event async for event in events]
    return list(events)


async def final(manager, get):
    """Reads a stream of the client's own helper to its end, and returns what the helper put together."""
    if hasattr(manager, "__aenter__"):
        async with manager as stream:
            events = [event async for event in stream]
            return events, await get(stream)
    with manager as stream:
        return list(stream), get(stream)


async def refused(kind, param, ask):
    try:
        await done(ask())
    except kind as error:
        assert error.param == param, error
        assert isinstance(error.body, dict) and error.body["message"], error.body
    else:
        raise AssertionError(f"{param} was not refused")


class Action(pydantic.BaseModel):
    """What the second stage asks for."""

    pick: Literal["(60, 60)", "(164, 60)", "(164, 164)", "(60, 164)"]
    place: Literal["(60, 60)", "(164, 60)", "(164, 164)", "(60, 164)"]


CHOOSE = [
    {
        "role": "user",
        "content": "- Method of folding: Pick the top left corner and place it on the bottom right corner\n"
        "- Cloth corners: (60, 60), (164, 60), (164, 164), (60, 164)\nPick Point = (x, y)\nPlace Point = (x, y)",
    }
]
HELLO = [{"role": "user", "content": "hello"}]


async def models(client):
    assert [model.id for model in await every(await done(client.models.list()))] == ["geometric"]
    assert (await done(client.models.retrieve("geometric"))).owned_by == "fabc"


async def pictures(client):
    chat, responses = client.chat.completions, client.responses
    settings = {"model": "geometric", "temperature": 0.2}
    completion = await done(chat.create(messages=turns(chat_part), max_tokens=1000, seed=4, **settings))
    said = completion.choices[0].message.content
    assert said.startswith("Instructions: "), said
    assert completion.choices[0].finish_reason == "stop"
    usage = completion.usage
    assert usage.prompt_tokens > 100 and usage.total_tokens == usage.prompt_tokens + usage.completion_tokens, usage

    options = {"include_usage": True}
    streamed = await done(
        chat.create(
            messages=turns(chat_part), max_tokens=1000, seed=4, stream=True, stream_options=options, **settings
        )
    )
    *chunks, last = await every(streamed)
    assert last.usage == usage and last.choices == [], last
    assert "".join(chunk.choices[0].delta.content or "" for chunk in chunks) == said
    assert chunks[-1].choices[0].finish_reason == "stop"

    response = await done(responses.create(input=turns(response_part), max_output_tokens=1000, store=False, **settings))
    assert response.status == "completed"
    assert response.output_text == said, response.output_text
    assert response.usage.input_tokens == usage.prompt_tokens
    streamed = await done(responses.create(input=turns(response_part), max_output_tokens=1000, stream=True, **settings))
    events = await every(streamed)
    assert [event.sequence_number for event in events] == list(range(len(events)))
    assert "".join(event.delta for event in events if event.type == "response.output_text.delta") == said
    assert (events[0].type, events[-1].type) == ("response.created", "response.completed")
    assert events[-1].response.output_text == said

    for manager, get, of in [
        (
            chat.stream(messages=turns(chat_part), **settings),
            lambda stream: stream.get_final_completion(),
            lambda it: it.choices[0].message.content,
        ),
        (
            responses.stream(input=turns(response_part), **settings),
            lambda stream: stream.get_final_response(),
            lambda it: it.output_text,
        ),
    ]:
        events, whole = await final(manager, get)
        assert len(events) > 5 and of(whole) == said, whole

    as_jpeg = turns(lambda part: chat_part(part) if part["type"] == "text" else jpeg_part(part))
    completion = await done(chat.create(messages=as_jpeg, **settings))
    assert completion.choices[0].message.content.startswith("Instructions: ")


def jpeg_part(part):
    return {"type": "image_url", "image_url": {"url": jpeg_url(part)}}


async def schemas(client):
    completion = await done(
        client.chat.completions.parse(model="geometric", messages=CHOOSE, response_format=Action)
    )
    action = completion.choices[0].message.parsed
    assert action.pick != action.place, completion
    response = await done(client.responses.parse(model="geometric", input=CHOOSE, text_format=Action))
    assert response.output_parsed == action, response
    events, streamed = await final(
        client.chat.completions.stream(model="geometric", messages=CHOOSE, response_format=Action),
        lambda stream: stream.get_final_completion(),
    )
    assert streamed.choices[0].message.parsed == action
    events, streamed = await final(
        client.responses.stream(model="geometric", input=CHOOSE, text_format=Action),
        lambda stream: stream.get_final_response(),
    )
    assert streamed.output_parsed == action

    # It cannot answer this in the schema, and says so where the client looks for a refusal.
    message = await done(client.chat.completions.parse(model="geometric", messages=HELLO, response_format=Action))
    message = message.choices[0].message
    assert message.parsed is None and "does not follow the schema" in message.refusal, message
    events, streamed = await final(
        client.chat.completions.stream(model="geometric", messages=HELLO, response_format=Action),
        lambda stream: stream.get_final_completion(),
    )
    assert streamed.choices[0].message.refusal == message.refusal
    assert any(event.type == "refusal.delta" for event in events)
    response = await done(client.responses.parse(model="geometric", input=HELLO, text_format=Action))
    part = response.output[0].content[0]
    assert response.output_parsed is None and part.refusal == message.refusal, response
    events, streamed = await final(
        client.responses.stream(model="geometric", input=HELLO, text_format=Action),
        lambda stream: stream.get_final_response(),
    )
    assert streamed.output[0].content[0].refusal == message.refusal
    assert "response.refusal.done" in [event.type for event in events]


async def limits(client):
    cut = await done(client.chat.completions.create(model="geometric", messages=HELLO, max_completion_tokens=3))
    assert cut.choices[0].finish_reason == "length" and cut.usage.completion_tokens == 3, cut
    streamed = await done(client.chat.completions.create(model="geometric", messages=HELLO, max_tokens=3, stream=True))
    chunks = await every(streamed)
    assert chunks[-1].choices[0].finish_reason == "length"
    assert "".join(chunk.choices[0].delta.content or "" for chunk in chunks) == cut.choices[0].message.content
    response = await done(client.responses.create(model="geometric", input="hello", max_output_tokens=3))
    assert response.status == "incomplete", response
    assert response.incomplete_details.reason == "max_output_tokens"
    assert response.usage.output_tokens == 3
    events = await every(
        await done(client.responses.create(model="geometric", input="hello", max_output_tokens=3, stream=True))
    )
    assert events[-1].type == "response.incomplete"
    assert events[-1].response.output_text == response.output_text


async def refusals(client):
    far = [{"role": "user", "content": [{"type": "image_url", "image_url": {"url": "https://example.org/a.png"}}]}]
    tool = {"type": "function", "function": {"name": "fold", "parameters": {"type": "object"}}}
    for param, more in [
        ("n", {"n": 2}),
        ("logprobs", {"logprobs": True}),
        ("tools", {"tools": [tool]}),
        ("audio", {"audio": {"voice": "alloy", "format": "wav"}}),
        ("messages[0].content[0].image_url", {"messages": far}),
        ("response_format.type", {"response_format": {"type": "json_object"}}),
    ]:
        for stream in [False, True]:
            asked = {"model": "geometric", "messages": HELLO, "stream": stream, **more}
            await refused(openai.BadRequestError, param, lambda: client.chat.completions.create(**asked))
    for param, more in [
        ("tools", {"tools": [{"type": "web_search"}]}),
        ("include", {"include": ["message.output_text.logprobs"]}),
        ("background", {"background": True}),
        ("previous_response_id", {"previous_response_id": "resp_1"}),
    ]:
        for stream in [False, True]:
            asked = {"model": "geometric", "input": "hello", "stream": stream, **more}
            await refused(openai.BadRequestError, param, lambda: client.responses.create(**asked))
    await refused(openai.NotFoundError, "model", lambda: client.responses.create(model="gpt-4o", input="hello"))
    await refused(openai.NotFoundError, None, lambda: client.embeddings.create(model="geometric", input="hello"))


async def main():
    arguments = {"base_url": base_url, "api_key": "none is needed", "max_retries": 0}
    for client in [openai.OpenAI(**arguments), openai.AsyncOpenAI(**arguments)]:
        for check in [models, pictures, schemas, limits, refusals]:
            await check(client)
    together = openai.AsyncOpenAI(**arguments)
    await asyncio.gather(*[limits(together) for _ in range(16)])


asyncio.run(main())
