"""Drivers and scoreboards for generated designs under cocotb (1.8.1 and newer 1.x), with edof's golden model behind them.

| what | class |
|---|---|
| beats into and out of a chain, with the stalls of the cycle model | `StreamSource`, `StreamSink` |
| every boundary of a chain against the cycle model, word for word and cycle for cycle | `ChainScoreboard` |
| windows as words, patches as pictures | `windows`, `patch_words` |
| raw frames as pixels on the video input, codes from the video output | `VideoSource`, `VideoSink` |
| registers over UARTBone, or over AXI4-Lite | `UartBone`, `AxiLite` |
| the memory ports for cocotbext-axi | `memory_bus` |

The words that are expected come from `edof.words`, `edof.board_picture` and `edof.Design.cycles`; nothing is computed twice. A difference raises
`Mismatch`, which names stage, boundary, patch, element and cycle.
"""

from ._chain import ChainScoreboard, Mismatch, StreamSink, StreamSource, patch_words, reset_chain, windows
from ._registers import AxiLite, UartBone, memory_bus
from ._video import VideoSink, VideoSource

__all__ = [
    "AxiLite",
    "ChainScoreboard",
    "Mismatch",
    "StreamSink",
    "StreamSource",
    "UartBone",
    "VideoSink",
    "VideoSource",
    "memory_bus",
    "patch_words",
    "reset_chain",
    "windows",
]
