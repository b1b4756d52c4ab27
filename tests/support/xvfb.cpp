#include "tests/support/xvfb.hpp"

namespace palpate::tests {

namespace {

/// The process that holds display `number`; 0: nobody, or it has ended without cleaning up.
pid_t holder_of(int number) {
    pid_t id = 0;
    std::ifstream(fmt::format("/tmp/.X{}-lock", number)) >> id;
    return id > 0 && kill(id, 0) == 0 ? id : 0;
}

}  // namespace

Xvfb::Xvfb(int width, int height, bool second) {
    // Displays are taken from the process id, so that tests side by side seldom meet; -displayfd
    // would choose one by itself, but only tells it over a pipe that the child would have to
    // inherit. Where two do meet, the lock file says whose the display is.
    for (int attempt = 0; attempt < 50; ++attempt) {
        const int number = 100 + (static_cast<int>(getpid()) * 7 + attempt) % 800;
        if (holder_of(number) != 0) {
            continue;
        }
        display_ = fmt::format(":{}", number);
        Words words{"Xvfb",      display_, "-screen", "0", fmt::format("{}x{}x24", width, height),
                    "-nolisten", "tcp",    "-noreset"};
        if (second) {
            words.insert(words.end(), {"-screen", "1", "1024x768x24"});
        }
        server_ = std::make_unique<Process>(words);
        for (int wait = 0; wait < 6000 && server_->running(); ++wait) {
            if (holder_of(number) == server_->id() &&
                std::filesystem::exists(fmt::format("/tmp/.X11-unix/X{}", number))) {
                return;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        if (server_->running()) {
            break;
        }
    }
    throw std::runtime_error("Xvfb did not come up; install the package xvfb");
}

Xvfb::~Xvfb() {
    server_->signal(
        SIGTERM);  // it takes its socket and lock file away; Process kills what does not end
    for (int wait = 0; wait < 500 && server_->running(); ++wait) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
}

}  // namespace palpate::tests
