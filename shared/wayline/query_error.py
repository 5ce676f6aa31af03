"""Pure: a question that cannot be answered as it was asked, over HTTP or as a Zenoh query."""

from typing import Literal


class QueryError(Exception):
    """Says what is wrong with a question. HTTP makes a problem of it, with its status.

    `status` is 404 where what was asked for is not known, 422 where a parameter does not fit, 503
    where nothing can be told now;
    `parameter` names the parameter then.
    """

    def __init__(
        self, status: Literal[404, 422, 503], detail: str, *, parameter: str | None = None
    ) -> None:
        self.status, self.detail, self.parameter = status, detail, parameter
        super().__init__(f"{parameter}: {detail}" if parameter else detail)
