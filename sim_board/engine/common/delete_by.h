#pragma once

namespace koboshi::sim_board {

// Deleter for std::unique_ptr that calls the library's own function.
template <auto kDelete>
struct DeleteBy {
  template <typename T>
  void operator()(T* object) const {
    kDelete(object);
  }
};

}  // namespace koboshi::sim_board
