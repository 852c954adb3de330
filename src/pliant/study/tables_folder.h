#pragma once

#include <string>

namespace pliant {

/// Makes `folder`, where the study of that name (as "cloth") puts tables and pictures and replaces
/// those that it put there before: study.yaml says that they are its own. Throws InputError where
/// the folder cannot be made, or holds tables or pictures that are not this study's.
void claim_tables_folder(const std::string& folder, const std::string& study);

}  // namespace pliant
