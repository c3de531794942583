"""LiteX's clients against a simulated board: CommUART at its line, and RemoteClient with the map of `edof board map --format csr-csv`."""

import subprocess
import sys
import time
import zlib

from litex.tools.litex_client import RemoteClient
from litex.tools.remote.comm_uart import CommUART

port, map_file, baud = sys.argv[1], sys.argv[2], int(sys.argv[3])

ID, SCRATCH, READS, WEIGHTS = 0x00, 0x18, 0x200, 0x0800_0000
ROWS = 16


def weights(stage, space, bank, row, half):
    return WEIGHTS + 4 * (stage << 21 | space << 19 | bank << 13 | row << 1 | half)


line = CommUART(port, baudrate=baud)
line.open()
assert line.read(ID) == 0x45444F46, "id"
line.write(SCRATCH, 0x1234_5678)
assert line.read(SCRATCH) == 0x1234_5678, "scratch"
words = line.read(ID, length=8)
assert words[0] == 0x45444F46 and words[6] == 0x1234_5678, words

# The first rows of the second set of the third stage (M), whose rows follow those of the first set; then their CRC.
stage, first = 2, int(sys.argv[4])
rows = [[(37 * row + half) * 0x01010101 & 0xFFFFFFFF for half in (0, 1)] for row in range(ROWS)]
for number, row in enumerate(rows):
    line.write(weights(stage, 0, 0, first + number, 0), row)
line.write(weights(stage, 3, 0, 3, 0), first << 12 | ROWS - 1)
while line.read(READS + 4 * (4 * stage + 3)):
    time.sleep(0.01)
expected = zlib.crc32(b"".join(word.to_bytes(4, "little") for row in rows for word in row))
found = line.read(READS + 4 * (4 * stage))
assert found == expected, f"CRC 0x{found:08x}, expected 0x{expected:08x}"
line.close()
print("CommUART: id, scratch, a burst, 32 words of weights and their CRC")

server = subprocess.Popen(
    [sys.executable, "-m", "litex.tools.litex_server", "--uart", f"--uart-port={port}", f"--uart-baudrate={baud}"],
    stdout=subprocess.DEVNULL,
)
try:
    for attempt in range(50):
        try:
            client = RemoteClient(csr_csv=map_file)
            client.open()
            break
        except ConnectionRefusedError:
            time.sleep(0.2)
    assert client.regs.edof_id.read() == 0x45444F46, "id through the server"
    client.regs.edof_scratch.write(0xCAFE_F00D)
    assert client.regs.edof_scratch.read() == 0xCAFE_F00D, "scratch through the server"
    client.close()
finally:
    server.terminate()
    server.wait()
print("litex_server and RemoteClient: registers by name")
