# README.md's commands that pack and install shapebench (scripts/test_dockerfile.sh holds them together):
#     docker build -t shapebench . && docker run --rm shapebench tables
FROM debian:12 AS build
COPY . /shapebench
WORKDIR /shapebench
RUN scripts/setup package
RUN cmake -S . -B build -G Ninja -DCMAKE_BUILD_TYPE=Release
RUN cmake --build build
RUN cpack --config build/CPackConfig.cmake -B build

FROM debian:12
COPY --from=build /shapebench/build/shapebench_*.deb build/
RUN apt-get update
RUN apt-get install -y ./build/shapebench_*.deb
ENTRYPOINT ["shapebench"]
