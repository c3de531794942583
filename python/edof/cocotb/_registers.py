"""Registers and memory of a core: AXI4-Lite, UARTBone, and the AXI4 ports under the names that cocotbext-axi looks for."""

from __future__ import annotations

from typing import Any, Sequence

import edof
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge


class AxiLite:
    """A master of the registers at a core's `host_*` port. Addresses are of bytes (docs/host.md)."""

    def __init__(self, dut: Any, clock: Any, prefix: str = "host") -> None:
        self.dut, self.clock, self.prefix = dut, clock, prefix
        for name in ("aw_valid", "w_valid", "ar_valid", "b_ready", "r_ready", "aw_addr", "w_data", "w_strb", "ar_addr"):
            self._in(name).value = 0

    def _in(self, name: str) -> Any:
        return getattr(self.dut, f"{self.prefix}_{name}_i")

    def _out(self, name: str) -> Any:
        return getattr(self.dut, f"{self.prefix}_{name}_o")

    async def write(self, address: int, word: int) -> None:
        """Writes a word; an error answer raises."""
        self._in("aw_addr").value, self._in("w_data").value, self._in("w_strb").value = address, word, 15
        waits = {"aw", "w"}
        self._in("b_ready").value = 1
        for name in waits:
            self._in(f"{name}_valid").value = 1
        answered = False
        while waits or not answered:
            await RisingEdge(self.clock)
            for name in list(waits):
                if int(self._out(f"{name}_ready").value):
                    self._in(f"{name}_valid").value = 0
                    waits.remove(name)
            if int(self._out("b_valid").value):
                answered = True
                if int(self._out("b_resp").value):
                    raise edof.EdofError(f"address 0x{address:x}: the write was answered with an error")
        self._in("b_ready").value = 0

    async def read(self, address: int) -> int:
        """Reads a word; an error answer raises."""
        self._in("ar_addr").value = address
        self._in("ar_valid").value, self._in("r_ready").value = 1, 1
        while True:
            await RisingEdge(self.clock)
            if int(self._out("ar_ready").value):
                self._in("ar_valid").value = 0
            if int(self._out("r_valid").value):
                break
        self._in("r_ready").value = 0
        if int(self._out("r_resp").value):
            raise edof.EdofError(f"address 0x{address:x}: the read was answered with an error")
        return int(self._out("r_data").value)


class UartBone:
    """A host at a serial line of `bit` clock cycles per bit: words over UARTBone, as `edof board` sends them."""

    def __init__(self, clock: Any, receive: Any, transmit: Any, bit: int) -> None:
        self.clock, self.receive, self.transmit, self.bit = clock, receive, transmit, bit
        self.receive.value = 1

    async def _send(self, data: bytes) -> None:
        for byte in data:
            for level in [0, *((byte >> place) & 1 for place in range(8)), 1]:
                self.receive.value = level
                await ClockCycles(self.clock, self.bit)

    async def _take(self, count: int) -> bytes:
        taken = bytearray()
        while len(taken) < count:
            await FallingEdge(self.transmit)
            await ClockCycles(self.clock, self.bit + self.bit // 2)
            byte = 0
            for place in range(8):
                byte |= int(self.transmit.value) << place
                await ClockCycles(self.clock, self.bit)
            taken.append(byte)
        return bytes(taken)

    async def write(self, address: int, words: Sequence[int]) -> None:
        """Writes words (255 at most) from a byte address on."""
        await self._send(edof.uartbone_write(address, words))

    async def read(self, address: int, words: int = 1) -> list[int]:
        """Reads words (255 at most) from a byte address on."""
        import cocotb

        answer = cocotb.start_soon(self._take(4 * words))
        await self._send(edof.uartbone_read(address, words))
        return edof.uartbone_words(await answer)


class _Renamed:
    """A core's memory ports under the names of AXI4."""

    def __init__(self, dut: Any) -> None:
        self._log = dut._log
        self._name = dut._name
        fields = {
            "write": {"aw": "id addr len size burst valid ready", "w": "data strb last valid ready", "b": "id resp valid ready"},
            "read": {"ar": "id addr len size burst valid ready", "r": "id data resp last valid ready"},
        }
        for way, channels in fields.items():
            for channel, names in channels.items():
                for name in names.split():
                    for end in ("i", "o"):
                        port = f"dram_{way}_{channel}_{name}_{end}"
                        if hasattr(dut, port):
                            setattr(self, f"m_axi_{channel}{name}", getattr(dut, port))


def memory_bus(dut: Any) -> Any:
    """The memory ports of `edof_core` as cocotbext-axi's `AxiBus`, for its `AxiRam`."""
    from cocotbext.axi import AxiBus

    return AxiBus.from_prefix(_Renamed(dut), "m_axi")
