"""Identification of servo drives in continuous time.

The transfer function of a drive,

    G(s) = (b_k s^k + .. + b_0) / (s^m + a_{m-1} s^{m-1} + .. + a_0) e^(-s d dt),

with a standard deviation of every number, from

* a record: :func:`identify`, many structures compared: :func:`select`, gains for a loop: :func:`tune`;
* samples as they come, as on a microcontroller: :class:`Identifier`;

and the adaptive position loop on a simulated pneumatic axis: :class:`ServoLoop`, :func:`simulate_axis`.

Everything is computed by the same Rust code as the command ``trendid`` and the firmware run; the numbers are the same to the last bit.
What cannot be used is refused by a :class:`Refusal` (a ``ValueError``) that names the value.
"""

from ._axis import Axis, Log, Model, ServoLoop, simulate_axis
from ._identifier import Identifier, Pass, Reading
from ._record import Identification, Quantity, identify
from ._selection import Candidate, Dropped, Selection, select
from ._trendid import Refusal, __version__
from ._tuning import Loop, Margins, Tuned, tune

__all__ = [
    "Axis",
    "Candidate",
    "Dropped",
    "Identification",
    "Identifier",
    "Log",
    "Loop",
    "Margins",
    "Model",
    "Pass",
    "Quantity",
    "Reading",
    "Refusal",
    "Selection",
    "ServoLoop",
    "Tuned",
    "__version__",
    "identify",
    "select",
    "simulate_axis",
    "tune",
]
