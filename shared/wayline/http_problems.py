"""Every HTTP error as RFC 9457 problem details."""

import http

import msgspec
from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException

from wayline.query_error import QueryError

MEDIA_TYPE = "application/problem+json"


class InvalidParameter(msgspec.Struct, frozen=True):
    """One parameter that a request got wrong."""

    name: str
    reason: str


class Problem(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """The body of every error answer."""

    type: str = "about:blank"
    title: str
    status: int
    detail: str | None = None
    instance: str | None = None
    invalid: tuple[InvalidParameter, ...] = ()


class ProblemResponse(Response):
    """A problem as an answer."""

    media_type = MEDIA_TYPE

    def __init__(self, problem: Problem, headers: dict[str, str] | None = None) -> None:
        # the type says nothing by RFC 9457 when it is about:blank, but readers expect the member
        body = {"type": problem.type} | msgspec.to_builtins(problem)
        super().__init__(msgspec.json.encode(body), problem.status, headers)


def problem(status: int, detail: str | None, instance: str) -> Problem:
    """A problem titled by its status code."""
    title = http.HTTPStatus(status).phrase
    return Problem(title=title, status=status, detail=detail, instance=instance)


def query_problem(error: QueryError, instance: str) -> Problem:
    """A query error as a problem; `instance` is the path or key that was asked."""
    refused = problem(error.status, str(error), instance)
    if error.parameter is None:
        return refused
    invalid = (InvalidParameter(error.parameter, error.detail),)
    return msgspec.structs.replace(refused, invalid=invalid)


def answer_with_problems(app: FastAPI) -> None:
    """Make every error of the app a problem, those of the framework included."""
    app.add_exception_handler(HTTPException, _http_exception)
    app.add_exception_handler(RequestValidationError, _invalid_request)
    app.add_exception_handler(QueryError, _unanswered)
    app.add_exception_handler(Exception, _bug)


def _http_exception(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)  # noqa: S101 - what it is registered for
    title = http.HTTPStatus(error.status_code).phrase
    detail = error.detail if error.detail != title else None
    headers = dict(error.headers) if error.headers else None
    return ProblemResponse(problem(error.status_code, detail, request.url.path), headers)


def _invalid_request(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)  # noqa: S101 - what it is registered for
    invalid = tuple(
        InvalidParameter(".".join(str(part) for part in found["loc"][1:]), str(found["msg"]))
        for found in error.errors()
    )
    detail = "; ".join(f"{parameter.name}: {parameter.reason}" for parameter in invalid)
    unfit = problem(422, detail, request.url.path)
    return ProblemResponse(msgspec.structs.replace(unfit, invalid=invalid))


def _unanswered(request: Request, error: Exception) -> Response:
    assert isinstance(error, QueryError)  # noqa: S101 - what it is registered for
    return ProblemResponse(query_problem(error, request.url.path))


def _bug(request: Request, _: Exception) -> Response:
    # the server logs the traceback; a client learns nothing of the inside
    return ProblemResponse(problem(500, "an error in the service; see its log", request.url.path))
