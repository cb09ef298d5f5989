"""Work on a Dask cluster or in this process. The only place that makes a client."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeVar

from lce_solver.errors import EnvironmentFault

if TYPE_CHECKING:
    from distributed import Client

Result = TypeVar("Result")

PATIENCE = "10s"
"""How long a scheduler may take to answer."""


@contextmanager
def client(address: str | None) -> Iterator[Client | None]:
    """A client of the Dask scheduler at ``address``, such as tcp://10.0.0.5:8786; none for work in this process.

    The workers need this package, and the folders of this machine under the same names.

    Raises
    ------
    EnvironmentFault
        Nobody answers at the address, or Dask is not installed.
    """
    if address is None:
        yield None
        return
    try:
        from distributed import Client  # noqa: PLC0415 (it takes a second, and few use it)
        from distributed.comm import get_address_host_port  # noqa: PLC0415

        get_address_host_port(address)  # a client that fails half-way tells so again, at exit
        workers = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, ImportError) as fault:
        msg = f"--scheduler {address}: no Dask scheduler answers there ({fault}); start one or leave the option out"
        raise EnvironmentFault(msg) from None
    try:
        yield workers
    finally:
        workers.close()


def each(workers: Client | None, function: Callable[..., Result], *columns: Iterable[Any]) -> Iterator[Result]:
    """``function`` of every row of ``columns``, in their order: on the workers all at once, else one by one."""
    if workers is None:
        yield from map(function, *columns)
        return
    futures = [workers.submit(function, *row, pure=False) for row in zip(*columns, strict=False)]
    try:
        for future in futures:
            yield future.result()
    finally:
        workers.cancel(futures)
