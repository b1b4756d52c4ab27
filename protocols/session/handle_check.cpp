#include "protocols/session/handle_check.hpp"

#include <chrono>
#include <exception>

namespace palpate::protocols {

HandleCheck::HandleCheck(Apparatus& apparatus, const RigTrust& trust)
    : apparatus_(apparatus), trust_(trust) {
    if (apparatus.has_proof()) {
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
            prove();
        } catch (const std::exception& e) {
            refused_ = e.what();
        }
    } while (resting_.load() && !refused_.empty());
    over_.store(true);
}

void HandleCheck::prove() {
    refused_.clear();
    while (trust_.state != Trust::proved && refused_.empty()) {
        ProofStep step = prove_step(apparatus_, trust_.state);
        refused_ = std::move(step.refused);
        if (step.event) {
            trust_ = apply(trust_, *step.event);
            proved_.push_back(*std::move(step.event));
        }
    }
}

}  // namespace palpate::protocols
