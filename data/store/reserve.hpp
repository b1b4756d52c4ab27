#pragma once

#include <cstdint>
#include <string>
#include <utility>

namespace palpate::data {

/// Room on a file's disk that nobody else can fill: a file without a name, so that nothing is left
/// of it however the program ends. When the disk turns out to be full it is given back piece by
/// piece: another program that goes on filling the disk gets little of it.
class Reserve {
public:
    /// @param file  whose disk it is; holds nothing yet
    explicit Reserve(std::string file) : file_(std::move(file)) {}
    Reserve(const Reserve&) = delete;
    Reserve& operator=(const Reserve&) = delete;
    ~Reserve();

    /// Holds at least `bytes` from here on. On a disk that cannot set room aside (some network
    /// disks) it only looks whether they are free now.
    /// @throws StoreError if the disk does not have them; what was held is held still
    void hold(std::int64_t bytes);
    /// Frees 1 MB, more than one save() writes. @return false: there was none
    bool give_back();

private:
    [[nodiscard]] int take(std::int64_t bytes);

    std::string file_;
    int descriptor_ = -1;
    std::int64_t held_ = 0;
};

}  // namespace palpate::data
