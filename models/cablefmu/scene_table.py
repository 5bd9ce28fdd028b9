"""What every table of a scene file has in common: its way of checking, and values per link."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    GetJsonSchemaHandler,
    ModelWrapValidatorHandler,
    Tag,
    ValidationError,
    ValidationInfo,
    model_validator,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, InitErrorDetails, PydanticCustomError

from cablefmu.units import refusal

__all__ = ["MARKS", "Context", "PerLink", "Table", "context_of", "one_per_link"]

MARKS = ("<one>", "<list>", "<number>", "<table>")
"""Entries of pydantic's error locations that are no keys: which branch of a choice was taken."""


@dataclass(frozen=True, slots=True)
class Context:
    """What a table must know of the rest of the scene while it is read."""

    links: int | None
    """Number of links, None if the scene does not say it properly."""
    read: Callable[[str], bytes]
    """Content of a file that the scene names; raises `CsvError` if that cannot be had."""


def context_of(info: ValidationInfo) -> Context | None:
    return info.context if isinstance(info.context, Context) else None


T = TypeVar("T")


def one_per_link(values: tuple[T, ...], info: ValidationInfo) -> tuple[T, ...]:
    context = context_of(info)
    if context is not None and context.links is not None and len(values) != context.links:
        raise refusal(f"a list needs one entry per link, {context.links} in all; this one has {len(values)}")
    return values


PerLink = Annotated[
    Annotated[T, Tag("<one>")] | Annotated[tuple[T, ...], AfterValidator(one_per_link), Tag("<list>")],
    Discriminator(lambda value: "<list>" if isinstance(value, list | tuple) else "<one>"),
]
"""One value for all links, or a list with one entry per link, link 1 (at the top) first."""


class Table(BaseModel):
    """One table of a scene file: no unknown keys, nothing changes afterwards."""

    model_config = ConfigDict(extra="forbid", frozen=True, use_attribute_docstrings=True)

    one_of: ClassVar[tuple[tuple[str, ...], ...]] = ()
    """Groups of keys of which exactly one must be given."""

    @classmethod
    def contradictions(cls, data: dict[str, Any]) -> Iterator[tuple[tuple[str, ...], str]]:
        """What is wrong between the keys of a table as written: where, and the sentence."""
        for group in cls.one_of:
            given = [key for key in group if key in data]
            if len(given) != 1:
                state = " and ".join(given) + " contradict each other" if given else "something is missing"
                yield (), f"{state}: exactly one of {', '.join(group)} is needed"

    @model_validator(mode="wrap")
    @classmethod
    def _check(cls, data: Any, handler: ModelWrapValidatorHandler[Any]) -> Any:
        """Report contradictions together with what is wrong in the single keys, not one after the other."""
        found = list(cls.contradictions(data)) if isinstance(data, dict) else []
        try:
            made = handler(data)
        except ValidationError as error:
            if not found:
                raise
            rest = error.errors(include_url=False)
        else:
            rest = []
        if not found:
            return made
        details = [InitErrorDetails(type=refusal(text), loc=loc, input=_value_at(data, loc)) for loc, text in found]
        details += [
            InitErrorDetails(
                type=PydanticCustomError(e["type"], "{text}", {**e.get("ctx", {}), "text": e["msg"]}),
                loc=e["loc"],
                input=e["input"],
            )
            for e in rest
        ]
        raise ValidationError.from_exception_data(cls.__name__, details)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        made = handler(schema)
        if cls.one_of:
            choices = [{"oneOf": [{"required": [key]} for key in group]} for group in cls.one_of]
            handler.resolve_ref_schema(made)["allOf"] = choices
        return made


def _value_at(data: Any, loc: tuple[str, ...]) -> Any:
    for key in loc:
        data = data.get(key) if isinstance(data, dict) else None
    return data
