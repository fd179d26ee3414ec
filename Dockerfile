# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
#   docker build -t sgs . && docker run --rm -v "$PWD:/work" -w /work sgs run my_recording -o out
FROM debian:bookworm AS build
COPY . /src
RUN cd /src && scripts/install_packages.sh && scripts/build_packages.sh /packages

FROM debian:bookworm-slim
SHELL ["/bin/bash", "-c"]
COPY --from=build /packages/*.deb /packages/
RUN apt-get update -q && \
    apt-get install -q -y --no-install-recommends /packages/{sgs,sgs-mesh,sgs-video,libsgs0,python3-sgs}_*.deb && \
    rm -rf /packages /var/lib/apt/lists/*
ENTRYPOINT ["sgs"]
