#include "pliant/effects/sheet_search.h"

#include "pliant/solvers/backend.h"

namespace pliant {

#ifndef PLIANT_CUDA_BACKEND
std::unique_ptr<SheetSearch> make_cuda_sheet_search(const SheetTreeSearch&) {
  throw DeviceFailure(why_no_cuda());
}
#endif

}  // namespace pliant
