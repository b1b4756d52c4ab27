#pragma once

#include <cstdint>

#include "protocols/session/recorder.hpp"
#include "data/store/database.hpp"

/// What each interval of a trial let one feel, and how it was felt: the table presentation.
namespace palpate::data {


void write_presentation(Database& database,
                        std::int64_t trial,
                        const protocols::Presentation& felt,
                        const protocols::SceneConstants& scene);

/// The numbers of an interval when its trial has ended.
void write_interval_result(Database& database,
                           std::int64_t trial,
                           std::int64_t interval,
                           const protocols::IntervalResult& result);

void write_response(Database& database,
                    std::int64_t trial,
                    const protocols::Protocol& protocol,
                    const protocols::Response& response);

}  // namespace palpate::data
