"""The bytes of a state: what they say of themselves, and that nothing else is taken for them."""

from __future__ import annotations

import hashlib
import random
import struct

import pytest
from fmpy.fmi1 import FMICallException

from cablefmu import __version__
from tests.conftest import Unpacked
from tests.fmi.test_state import STEP, STEPS, everything, run, start
from tests.fmu_helpers import Host

both = pytest.mark.parametrize("fmi", [2, 3])
HEADER = struct.Struct("<8s2I16s40s2IQ")
FIELDS = ("magic", "format", "layout", "version", "token", "n", "interface", "size")
CHECKSUM = 32
FIRST_FLAGS = struct.Struct("<2i")
"""Behind the header: the mode, and whether the start is current."""


def header(image: bytes) -> dict[str, int | bytes]:
    return dict(zip(FIELDS, HEADER.unpack_from(image), strict=True))


def sealed(body: bytes) -> bytes:
    """With a checksum that is right, as somebody would make it who knows how."""
    return body + hashlib.sha256(body).digest()


def forged(image: bytes, **changes: int | bytes) -> bytes:
    """The same image with other things said in its header."""
    return sealed(HEADER.pack(*(header(image) | changes).values()) + image[HEADER.size : -CHECKSUM])


def saved(host: Host) -> bytes:
    run(start(host, 3, {"u_m1": 100.0}), range(3))
    return host.save()


@both
def test_it_says_what_it_is(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        image = saved(host)
        told = header(image)
        assert told["magic"] == b"CABLESTA"
        assert told["version"] == __version__.encode().ljust(16, b"\0"), "fmu_src/fmi/version.h is the package's"
        assert told["token"] == host.description.guid.encode().ljust(40, b"\0")
        assert (told["n"], told["interface"], told["size"]) == (5, 1, len(image) - CHECKSUM)
        assert image == sealed(image[:-CHECKSUM])


@both
def test_the_same_state_is_the_same_bytes(fmi: int, unpacked: Unpacked) -> None:
    """No padding, no addresses: whoever compares or archives images can rely on it."""
    folder = unpacked("load", fmi)
    with Host(folder) as one, Host(folder) as other:
        assert saved(one) == saved(other) == one.save()
        assert other.load(one.save()).save() == one.save()


@both
def test_one_wrong_bit_anywhere_is_found(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        image = saved(host)
        before = everything(host)
        for k in range(len(image)):
            damaged = bytearray(image)
            damaged[k] ^= 1 << k % 8
            assert host.refusal(host.state_in, bytes(damaged)).startswith("deserializing a state: it")
        assert everything(host) == before
        assert host.load(image).save() == image


@both
def test_a_wrong_length_is_found(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        image = saved(host)
        for length in range(len(image)):
            message = host.refusal(host.state_in, image[:length])
            expected = len(image) if length >= HEADER.size + CHECKSUM else HEADER.size + CHECKSUM
            assert message == f"deserializing a state: its bytes are {length}; expected is {expected}"
        assert "expected is" in host.refusal(host.state_in, image + b"\0")


@both
def test_noise_is_refused(fmi: int, unpacked: Unpacked) -> None:
    chance = random.Random(6)
    with Host(unpacked("load", fmi)) as host:
        image = saved(host)
        for _ in range(200):
            noise = chance.randbytes(chance.randrange(len(image)))
            host.refusal(host.state_in, noise)
            host.refusal(host.state_in, image[: HEADER.size] + noise)
            host.refusal(host.state_in, sealed(image[: HEADER.size] + noise))
        host.step(3 * STEP, STEP)


WRONG = {
    "magic": (b"CABLESTB", "it is not a state of a cable"),
    "format": (1, "its format is 1; expected is 2"),
    "layout": (7, "its layout is 7; expected is "),
    "version": (b"0.0.9".ljust(16, b"\0"), f"its library's version is 0.0.9; expected is {__version__}"),
    "token": (b"{0}".ljust(40, b"\0"), "it is of another cable, whose token is {0}; expected is {"),
    "n": (6, "its number of links is 6; expected is 5"),
    "interface": (0, "its interface is Model Exchange; expected is Co-Simulation"),
    "size": (2**64 - CHECKSUM, "its bytes are "),
}


@both
@pytest.mark.parametrize("field", WRONG)
def test_an_image_of_something_else_is_refused(field: str, fmi: int, unpacked: Unpacked) -> None:
    value, says = WRONG[field]
    with Host(unpacked("load", fmi)) as host:
        image = saved(host)
        assert host.refusal(host.state_in, forged(image, **{field: value})).startswith(f"deserializing a state: {says}")
        host.load(forged(image))


@both
def test_another_scene_and_the_other_interface_are_refused(fmi: int, unpacked: Unpacked) -> None:
    """As images, and as the handles of an instance beside this one."""
    with (
        Host(unpacked("load", fmi)) as host,
        Host(unpacked("air", fmi)) as foreign,
        Host(unpacked("load", fmi), interface="me") as exchange,
    ):
        before = everything(host)
        for other, says in ((foreign, "it is of another cable"), (exchange, "its interface is Model Exchange")):
            state = other.take()
            assert host.refusal(host.put, state).startswith(f"setting the state: {says}")
            assert host.refusal(host.state_in, other.save()).startswith(f"deserializing a state: {says}")
            other.free(state)
        assert everything(host) == before


@both
def test_numbers_that_no_instance_has_are_refused(fmi: int, unpacked: Unpacked) -> None:
    """Behind a checksum of somebody's own making: modes that the interface has not, and what is neither yes nor no."""
    with Host(unpacked("load", fmi)) as host:
        image = saved(host)
        body = image[:-CHECKSUM]
        mode, current = FIRST_FLAGS.unpack_from(body, HEADER.size)
        for wrong in ((0, 0), (3, 0), (4, 0), (8, 0), (32, 0), (-128, 0), (1 << 20, 0), (mode, 2), (mode, -1)):
            flags = FIRST_FLAGS.pack(*wrong)
            changed = body[: HEADER.size] + flags + body[HEADER.size + FIRST_FLAGS.size :]
            assert "it is damaged" in host.refusal(host.state_in, sealed(changed))
        same = body[: HEADER.size] + FIRST_FLAGS.pack(mode, current) + body[HEADER.size + FIRST_FLAGS.size :]
        assert sealed(same) == image


@both
def test_no_forgery_breaks_the_instance(fmi: int, unpacked: Unpacked) -> None:
    """Any four bytes replaced behind the header: refused or taken; then a step is made or refused."""
    chance = random.Random(14)  # a seed without a force so violent that a step takes its million attempts
    met = {"refused": 0, "no step": 0, "a step": 0}
    with Host(unpacked("load", fmi)) as host:
        image = saved(host)
        for at in range(HEADER.size, len(image) - CHECKSUM - 3, 4):
            changed = bytearray(image[:-CHECKSUM])
            changed[at : at + 4] = chance.choice([chance.randbytes(4), b"\xff\xff\xff\x7f", b"\0\0\0\x80"])
            met[after_forgery(host, sealed(bytes(changed)))] += 1
        host.load(image)
        assert len(run(host, range(3, STEPS))) == STEPS - 3
    assert all(met.values()), met


def after_forgery(host: Host, image: bytes) -> str:
    try:
        host.load(image)
    except FMICallException:
        return "refused"
    try:
        everything(host)
        host.step(host.get("time")[0] if host.fmi == 3 else 3 * STEP, STEP)
        everything(host)
    except FMICallException:
        return "no step"
    return "a step"
