# The command line `abbe` in an image of its own.
#
#     docker build --tag abbe .
#     docker run --rm --volume "$PWD:/work" abbe derive XYFZ
#
# The binary links nothing dynamically, so that the image holds it and nothing else.
FROM rust:1.95-alpine AS build
RUN apk add --no-cache musl-dev
WORKDIR /abbe
COPY . .
RUN cargo build --locked --release --package abbe --bin abbe

FROM scratch
COPY --from=build /abbe/target/release/abbe /abbe
COPY LICENSE-APACHE LICENSE-MIT NOTICE /
WORKDIR /work
ENTRYPOINT ["/abbe"]
