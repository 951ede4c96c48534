#!/bin/sh
# Makes a robot's authority, and a certificate for each of its computers, in the folder `certificates`:
#
#     ./certificates.sh body=192.168.0.10 left_arm=192.168.0.11 right_arm=192.168.0.12
#
# Each computer needs ca.pem, NAME.pem and NAME.key; ca.key stays where this was run.
set -eu
umask 077
mkdir -p certificates
cd certificates
new_key() { openssl req -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes "$@" 2>/dev/null; }
[ -e ca.pem ] || new_key -x509 -days 3650 -subj "/CN=authority of a robot" -keyout ca.key -out ca.pem
for computer; do
    name=${computer%%=*}
    new_key -subj "/CN=$name" -keyout "$name.key" -out "$name.csr"
    printf 'subjectAltName=DNS:%s,IP:%s\nextendedKeyUsage=serverAuth,clientAuth\nbasicConstraints=CA:FALSE\n' \
        "$name" "${computer#*=}" >"$name.extensions"
    openssl x509 -req -days 3650 -in "$name.csr" -CA ca.pem -CAkey ca.key -CAcreateserial -extfile "$name.extensions" \
        -out "$name.pem" 2>/dev/null
    rm "$name.csr" "$name.extensions"
done
