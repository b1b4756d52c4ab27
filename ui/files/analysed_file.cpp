#include "ui/files/analysed_file.hpp"

#include "data/store/analysed.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {

void analyse(data::Database& database,
             const std::string& versions,
             const std::string& study,
             bool codes) {
    data::analyse(database,
                  versions == "together" ? data::Versions::together : data::Versions::apart, study);
    say_to(stderr, data::withdrawn_text(database, codes));
}

}  // namespace palpate::ui
