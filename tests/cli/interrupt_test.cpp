#include "interrupt.h"

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

TEST_CASE("a held signal waits until the work is done, then ends the process") {
    int done[2];
    REQUIRE(pipe(done) == 0);
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        std::signal(SIGTERM, SIG_DFL);  // doctest has its own handler
        {
            const wavefog::cli::HoldInterrupts hold;
            std::raise(SIGTERM);
            if (write(done[1], "w", 1) != 1) _exit(1);
        }
        _exit(0);
    }
    close(done[1]);
    char work = 0;
    CHECK(read(done[0], &work, 1) == 1);
    CHECK(work == 'w');
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    CHECK(WIFSIGNALED(status));
    CHECK(WTERMSIG(status) == SIGTERM);
    close(done[0]);
}
