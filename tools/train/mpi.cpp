// SPDX-License-Identifier: BSD-3-Clause
// The only file that includes MPI.
#include <mpi.h>

#include <exception>
#include <numeric>
#include <vector>

#include "tools/train/join_ranks.h"

namespace sandrunner::train {
namespace {

// Where the part of each rank begins.
std::vector<int> begins(std::span<const int> bytes) {
  std::vector<int> at(bytes.size());
  std::exclusive_scan(bytes.begin(), bytes.end(), at.begin(), 0);
  return at;
}

// Errors of MPI end all ranks, which is its default.
class MpiExchange final : public learner::Exchange {
 public:
  MpiExchange() {
    int provided = 0;  // one thread calls: whatever is provided is enough
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
  }
  // A rank that fails leaves without a word: mpirun ends the others, which wait for it.
  ~MpiExchange() override {
    if (std::uncaught_exceptions() == 0) MPI_Finalize();
  }
  MpiExchange(const MpiExchange&) = delete;
  MpiExchange& operator=(const MpiExchange&) = delete;

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  void gather(std::span<std::byte> data, std::span<const int> bytes) override {
    const Call call(*this, bytes);
    MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, data.data(), bytes.data(),
                   begins(bytes).data(), MPI_BYTE, MPI_COMM_WORLD);
  }
  void trade(std::span<const std::byte> given, std::span<const int> given_bytes,
             std::span<std::byte> got, std::span<const int> got_bytes) override {
    const Call call(*this, got_bytes);
    MPI_Alltoallv(given.data(), given_bytes.data(), begins(given_bytes).data(), MPI_BYTE,
                  got.data(), got_bytes.data(), begins(got_bytes).data(), MPI_BYTE, MPI_COMM_WORLD);
  }

  Traffic traffic() const override { return traffic_; }

 private:
  // Counts a call that gets `got` bytes of each rank.
  class Call {
   public:
    Call(MpiExchange& exchange, std::span<const int> got) : exchange_(exchange) {
      const auto all = std::accumulate(got.begin(), got.end(), 0.0);
      exchange.traffic_.got_bytes += all - got[static_cast<std::size_t>(exchange.rank_)];
    }
    ~Call() { exchange_.traffic_.time_s += MPI_Wtime() - begin_s_; }
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;

   private:
    MpiExchange& exchange_;
    const double begin_s_ = MPI_Wtime();
  };

  int rank_ = 0, size_ = 1;
  Traffic traffic_;
};

}  // namespace

std::unique_ptr<learner::Exchange> join_ranks() { return std::make_unique<MpiExchange>(); }

}  // namespace sandrunner::train
