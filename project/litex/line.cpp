// A serial line behind a pseudo-terminal, for bench.sv: whoever opens it talks to the simulated board.
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

static int line = -1;

// Opens the line and prints its name.
extern "C" void line_open() {
    line = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (line < 0 || grantpt(line) || unlockpt(line)) {
        perror("pseudo-terminal");
        exit(1);
    }
    // Raw, and held open on the other side, so that a client may come and go.
    int held = open(ptsname(line), O_RDWR | O_NOCTTY);
    termios mode;
    tcgetattr(held, &mode);
    cfmakeraw(&mode);
    tcsetattr(held, TCSANOW, &mode);
    printf("line: %s\n", ptsname(line));
    fflush(stdout);
}

// The next byte for the board, -1 where there is none.
extern "C" int line_get() {
    unsigned char byte;
    return read(line, &byte, 1) == 1 ? byte : -1;
}

// A byte from the board.
extern "C" void line_put(int value) {
    unsigned char byte = value;
    while (write(line, &byte, 1) != 1) usleep(100);
}
