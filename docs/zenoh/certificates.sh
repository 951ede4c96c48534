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
# What a program says is shown where it fails.
quietly() { said=$("$@" 2>&1) || { printf '%s\n' "$said" >&2; exit 1; }; }
new_key() { quietly openssl req -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes "$@"; }
[ -e ca.pem ] || new_key -x509 -days 3650 -subj "/CN=authority of a robot" -keyout ca.key -out ca.pem
for computer; do
    case $computer in ?*=?*) ;; *) printf 'allowed: NAME=ADDRESS, not %s\n' "$computer" >&2; exit 2 ;; esac
    name=${computer%%=*}
    new_key -subj "/CN=$name" -keyout "$name.key" -out "$name.csr"
    printf 'subjectAltName=DNS:%s,IP:%s\nextendedKeyUsage=serverAuth,clientAuth\nbasicConstraints=CA:FALSE\n' \
        "$name" "${computer#*=}" >"$name.extensions"
    quietly openssl x509 -req -days 3650 -in "$name.csr" -CA ca.pem -CAkey ca.key -CAcreateserial -extfile "$name.extensions" \
        -out "$name.pem"
    rm "$name.csr" "$name.extensions"
done
