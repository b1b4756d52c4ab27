#include "protocols/session/handle_check.hpp"

#include <chrono>

namespace palpate::protocols {

HandleCheck::HandleCheck(Apparatus& apparatus) : apparatus_(apparatus) {
    if (apparatus.can_prove_handle()) {
        thread_ = std::thread([this] { live(); });
    } else {
        over_.store(true);
    }
}

HandleCheck::~HandleCheck() {
    finish();
    if (thread_.joinable()) {
        thread_.join();
    }
}

void HandleCheck::live() {
    constexpr auto kSlice = std::chrono::milliseconds(20);
    do {
        const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kLetGo);
        while (resting_.load() && std::chrono::steady_clock::now() < end) {
            std::this_thread::sleep_for(kSlice);
        }
        try {
            result_ = apparatus_.prove_handle();
        } catch (const std::exception& e) {
            result_ = engine::ShortForm{.refused = e.what(), .found = {}};
        }
    } while (resting_.load() && !result_->refused.empty());
    over_.store(true);
}

}  // namespace palpate::protocols
