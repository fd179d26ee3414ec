// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/graph/pose_graph.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <optional>

#include "sgs/core/error.h"

namespace sgs::graph {
namespace {

constexpr int kMaxSteps = 8;        // of Gauss-Newton at one set of weights
constexpr double kStopStep = 1e-9;  // rad and metres
constexpr double kGrowth = 1.4;     // of the cost's non-convexity
constexpr int kMaxGraduations = 60;

/// The normal equations of the graph: block-sparse, node 0 left out.
class NormalEquations {
 public:
  explicit NormalEquations(std::size_t nodes)
      : b_(Eigen::VectorXd::Zero(6 * static_cast<Eigen::Index>(nodes - 1))) {}

  void add(const Edge& edge, double weight, const SE3& T_from, const SE3& T_to) {
    const Vector6d e = disagreement(edge, T_from, T_to);
    const Matrix6d by_to = se3_right_jacobian_inverse(e);
    const Matrix6d by_from = -by_to * (T_to.inverse() * T_from).adjoint();
    const Matrix6d L = weight * edge.information;
    add_block(edge.from, edge.from, by_from.transpose() * L * by_from);
    add_block(edge.to, edge.to, by_to.transpose() * L * by_to);
    add_block(edge.from, edge.to, by_from.transpose() * L * by_to);
    add_gradient(edge.from, by_from.transpose() * (L * e));
    add_gradient(edge.to, by_to.transpose() * (L * e));
  }

  /// The step that solves H x = -b; empty where there is none.
  std::optional<Eigen::VectorXd> solve() const {
    Eigen::SparseMatrix<double> H(b_.size(), b_.size());
    H.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factors(H);
    if (factors.info() != Eigen::Success) return std::nullopt;
    Eigen::VectorXd x = factors.solve(-b_);
    if (!x.allFinite()) return std::nullopt;
    return x;
  }

 private:
  static Eigen::Index place(int node) { return 6 * (static_cast<Eigen::Index>(node) - 1); }

  // Lower triangle only.
  void add_block(int row, int column, const Matrix6d& block) {
    if (row == 0 || column == 0) return;
    const bool flip = row < column;
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) {
        const Eigen::Index r = flip ? place(column) + j : place(row) + i;
        const Eigen::Index c = flip ? place(row) + i : place(column) + j;
        if (r >= c) entries_.emplace_back(r, c, block(i, j));
      }
    }
  }
  void add_gradient(int node, const Vector6d& part) {
    if (node > 0) b_.segment<6>(place(node)) += part;
  }

  std::vector<Eigen::Triplet<double, Eigen::Index>> entries_;
  Eigen::VectorXd b_;
};

class Solver {
 public:
  Solver(std::vector<SE3> poses, const std::vector<Edge>& edges) : edges_(edges) {
    out_.T_world_node = std::move(poses);
    out_.weights.assign(edges.size(), 1.0);
    out_.chi2.assign(edges.size(), 0.0);
  }

  GraphSolution run() {
    for (const Edge& e : edges_) limits_.push_back(chi2_limit(rank(e.information)));
    // Far from the solution every edge may look wrong: first what is certain, which the doubtful
    // edges are then measured against.
    if (out_.T_world_node.size() > 1) graduate();
    return std::move(out_);
  }

 private:
  const SE3& pose(int node) const { return out_.T_world_node[static_cast<std::size_t>(node)]; }

  void measure() {
    for (std::size_t k = 0; k < edges_.size(); ++k) {
      out_.chi2[k] = chi2(edges_[k], pose(edges_[k].from), pose(edges_[k].to));
    }
  }

  void relax() {
    for (int step = 0; step < kMaxSteps; ++step) {
      NormalEquations equations(out_.T_world_node.size());
      for (std::size_t k = 0; k < edges_.size(); ++k) {
        if (out_.weights[k] <= 0) continue;
        equations.add(edges_[k], out_.weights[k], pose(edges_[k].from), pose(edges_[k].to));
      }
      const auto solved = equations.solve();
      ++out_.steps;
      if (!solved) {
        out_.found = false;
        return;
      }
      const Eigen::VectorXd& x = *solved;
      for (std::size_t n = 1; n < out_.T_world_node.size(); ++n) {
        SE3& T = out_.T_world_node[n];
        T = (T * SE3::exp(x.segment<6>(6 * static_cast<Eigen::Index>(n - 1)))).normalized();
      }
      if (x.lpNorm<Eigen::Infinity>() < kStopStep) break;
    }
    measure();
  }

  /// How far the worst doubtful edge lies beyond its limit (1 = at it).
  double worst() const {
    double ratio = 0;
    for (std::size_t k = 0; k < edges_.size(); ++k) {
      if (edges_[k].doubtful) ratio = std::max(ratio, out_.chi2[k] / limits_[k]);
    }
    return ratio;
  }

  // Raises the non-convexity step by step. Returns whether any weight is neither 0 nor 1.
  bool reweight(double mu) {
    bool undecided = false;
    for (std::size_t k = 0; k < edges_.size(); ++k) {
      if (!edges_[k].doubtful) continue;
      const double r2 = out_.chi2[k], c2 = limits_[k];
      double& w = out_.weights[k];
      if (r2 >= (mu + 1) / mu * c2) {
        w = 0;
      } else if (r2 <= mu / (mu + 1) * c2) {
        w = 1;
      } else {
        w = std::sqrt(c2 * mu * (mu + 1) / r2) - mu;
        undecided = true;
      }
    }
    return undecided;
  }

  void graduate() {
    relax();
    const double ratio = worst();
    if (ratio <= 1 || !out_.found) return;
    double mu = 1 / (2 * ratio - 1);
    for (int i = 0; i < kMaxGraduations; ++i, mu *= kGrowth) {
      const bool undecided = reweight(mu);
      relax();
      if (!out_.found) return;
      if (!undecided && mu > 1) break;
    }
    for (std::size_t k = 0; k < edges_.size(); ++k) {
      if (edges_[k].doubtful) out_.weights[k] = out_.chi2[k] <= limits_[k] ? 1 : 0;
    }
    relax();
  }

  const std::vector<Edge>& edges_;
  std::vector<double> limits_;
  GraphSolution out_;
};

}  // namespace

Vector6d disagreement(const Edge& edge, const SE3& T_world_from, const SE3& T_world_to) {
  return (edge.T_from_to.inverse() * T_world_from.inverse() * T_world_to).log();
}

double chi2(const Edge& edge, const SE3& T_world_from, const SE3& T_world_to) {
  const Vector6d e = disagreement(edge, T_world_from, T_world_to);
  return e.dot(edge.information * e);
}

int rank(const Matrix6d& information) {
  constexpr double kNothing = 1e-9;  // of the largest
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(information, Eigen::EigenvaluesOnly);
  const Vector6d& values = eigen.eigenvalues();
  return static_cast<int>((values.array() > kNothing * std::max(values[5], 1e-300)).count());
}

double chi2_limit(int degrees_of_freedom) {
  SGS_CHECK(degrees_of_freedom >= 1 && degrees_of_freedom <= 6, "1 to 6 degrees of freedom");
  constexpr std::array kLimits = {6.635, 9.210, 11.345, 13.277, 15.086, 16.812};
  return kLimits[static_cast<std::size_t>(degrees_of_freedom - 1)];
}

GraphSolution optimise(std::vector<SE3> T_world_node, const std::vector<Edge>& edges) {
  const auto nodes = static_cast<int>(T_world_node.size());
  for (const Edge& e : edges) {
    SGS_CHECK(e.from >= 0 && e.from < nodes && e.to >= 0 && e.to < nodes && e.from != e.to,
              "an edge joins two nodes");
  }
  return Solver(std::move(T_world_node), edges).run();
}

}  // namespace sgs::graph
