#!/bin/bash
# tools/farm on a real Slurm: munged, slurmctld and slurmd, with this machine as the one node, all
# that they write in a temporary folder.
#
#   tests/tools/farm_test.sh [PROGRAM]     default: build/softfocus
#
# Needs slurmctld, slurmd, slurm-client and munge; any user can run it.

set -uo pipefail
cd -P "$(dirname "${BASH_SOURCE[0]}")/../.." || exit 1
program=$(realpath "${1:-build/softfocus}")
farm=$PWD/tools/farm
failed=0

fail() {
  echo "failed: $*"
  failed=1
}

for needed in munged slurmctld slurmd sbatch; do
  PATH=$PATH:/usr/sbin command -v $needed >/dev/null && continue
  why="no $needed: apt-get install slurmctld slurmd slurm-client munge"
  case ",${SOFTFOCUS_REQUIRE-}," in
    *,all,* | *,slurm,*) echo "SOFTFOCUS_REQUIRE is $SOFTFOCUS_REQUIRE, but: $why" && exit 1 ;;
  esac
  echo "skipped: tools/farm on a real Slurm ($why)"
  exit 0
done
PATH=$PATH:/usr/sbin

work=$(mktemp -d /tmp/softfocus-farm-test-XXXXXX) || exit 1
daemons=()

stop_daemons() {
  local pid
  if [ ${#daemons[@]} -eq 3 ]; then
    scancel --user="$(id -un)" 2>/dev/null
    for _ in $(seq 50); do
      [ -n "$(squeue --noheader 2>/dev/null)" ] || break
      sleep 0.1
    done
  fi
  # The last one first: munged is what the others speak through.
  for ((i = ${#daemons[@]} - 1; i >= 0; --i)); do
    pid=${daemons[i]}
    kill "$pid" 2>/dev/null
    for _ in $(seq 50); do
      kill -0 "$pid" 2>/dev/null || break
      sleep 0.1
    done
    kill -9 "$pid" 2>/dev/null
    wait "$pid" 2>/dev/null
  done
}

finish() {
  stop_daemons
  rm -rf "$work"
}
trap finish EXIT
trap 'exit 1' INT TERM HUP

# free_ports: two numbers.
free_ports() {
  python3 -c 'import socket
ends = [socket.socket() for _ in range(2)]
for end in ends: end.bind(("127.0.0.1", 0))
print(*(end.getsockname()[1] for end in ends))'
}

start_daemons() {
  local host user ports slurm=$work/slurm
  host=$(hostname -s)
  user=$(id -un)
  ports=($(free_ports))
  mkdir "$slurm" "$slurm/state" "$slurm/spool"
  (umask 077 && head -c 1024 /dev/urandom >"$slurm/munge.key")
  cat >"$slurm/slurm.conf" <<END
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=${ports[0]}
SlurmdPort=${ports[1]}
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$slurm/munge.socket
CredType=cred/munge
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/spool
SlurmctldPidFile=$slurm/slurmctld.pid
SlurmdPidFile=$slurm/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
KillWait=2
SchedulerParameters=batch_sched_delay=0,sched_interval=1
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
  export SLURM_CONF=$slurm/slurm.conf
  munged --foreground --force --num-threads=1 --key-file="$slurm/munge.key" \
    --socket="$slurm/munge.socket" --pid-file="$slurm/munged.pid" \
    --log-file="$slurm/munged.log" --seed-file="$slurm/munge.seed" >"$slurm/munged.out" 2>&1 &
  daemons+=($!)
  for _ in $(seq 100); do
    [ ! -S "$slurm/munge.socket" ] || break
    sleep 0.1
  done
  slurmctld -D -i >"$slurm/slurmctld.out" 2>&1 &
  daemons+=($!)
  slurmd -D >"$slurm/slurmd.out" 2>&1 &
  daemons+=($!)
  for _ in $(seq 300); do
    [ "$(sinfo --noheader --format=%T 2>/dev/null)" != idle ] || return 0
    sleep 0.1
  done
  tail -n 5 "$slurm"/*.out
  return 1
}

# check_refused STATUS PART... -- ARGUMENT...: one line that names every part, and nothing left.
check_refused() {
  local status=$1 parts=() part said
  shift
  while [ "$1" != -- ]; do
    parts+=("$1")
    shift
  done
  shift
  said=$("$farm" "$@" 2>&1 >/dev/null)
  [ $? -eq "$status" ] && [ "$(wc -l <<<"$said")" -eq 1 ] || fail "tools/farm $*: $said"
  for part in "${parts[@]}"; do
    [[ $said == *"$part"* ]] || fail "tools/farm $*: '$part' is not in: $said"
  done
  [ -z "$(ls)" ] || fail "tools/farm $*: left $(ls)"
}

wrong_usage() {
  check_refused 2 --tasks -- -- "$program" render figures -o a.png
  check_refused 2 --tasks "'0'" -- --tasks 0 -- "$program" render figures -o a.png
  check_refused 2 --retries "'-1'" -- --tasks 2 --retries=-1 -- "$program" render figures -o a.png
  check_refused 2 'no command' -- --tasks 2
  check_refused 2 'no command' -- --tasks 2 -- "$program" compare a.png b.png
  check_refused 2 '-o' -- --tasks 2 -- "$program" render figures
  check_refused 2 '-o' -- --tasks 2 -- "$program" render figures -o -
  check_refused 2 --shard -- --tasks 2 -- "$program" render figures -o a.png --shard 1/2
  check_refused 1 "no program 'softfocus-of-nobody'" -- --tasks 2 -- softfocus-of-nobody render \
    figures -o a.png
  check_refused 1 none/a.png -- --tasks 2 -- "$program" render figures -o none/a.png
  check_without_sbatch
}

check_without_sbatch() {
  local python said
  python=$(python3 -c 'import sys; print(sys.executable)')
  said=$(PATH=/nowhere "$python" "$farm" --tasks 2 -- "$program" render figures -o a.png 2>&1)
  [[ $? -eq 1 && $said == "tools/farm: there is no sbatch"* ]] || fail "without sbatch: $said"
}

# A program in whose first run of shard 2/4 something happens in the middle: it stands still and
# leaves its number in $work/stopped, so that it can be killed there, however fast this machine is.
make_stopping_program() {
  cat >"$work/softfocus" <<END
#!/bin/bash
if [[ " \$* " == *" --shard 2/4"* ]] && mkdir "$work/first" 2>/dev/null; then
  "$program" "\$@" &
  sleep 0.1
  kill -STOP \$!
  echo \$! >"$work/number" && mv "$work/number" "$work/stopped"
  wait \$!
else
  exec "$program" "\$@"
fi
END
  chmod +x "$work/softfocus"
}

# farm_and_kill KILL ARGUMENT...: runs tools/farm, and KILL with the number of the process that
# stands still. Task 2 must be run again, and the farm succeed.
farm_and_kill() {
  local kill=$1 said=$work/said number
  shift
  rm -rf "$work/first" "$work/stopped"
  timeout 200 "$farm" --tasks 4 --sbatch=--cpus-per-task=1 -- "$@" 2>"$said" &
  local farm_pid=$!
  for _ in $(seq 600); do
    [ ! -e "$work/stopped" ] && kill -0 $farm_pid 2>/dev/null || break
    sleep 0.1
  done
  number=$(cat "$work/stopped") && "$kill" "$number" || fail "no task could be killed"
  wait $farm_pid || fail "tools/farm $*: $(cat "$said")"
  grep -q '^tools/farm: task 2 of 4 failed and is run again: ' "$said" ||
    fail "the killed task was not run again: $(cat "$said")"
}

kill_process() { kill -9 "$1"; }

cancel_task() { scancel "$(squeue --noheader --array --format='%i' | grep '_2$')"; }

accumulation() {
  local render=(render figures --method accumulation --jitter --samples 200 --size 300x200)
  "$program" "${render[@]}" -o one.png
  farm_and_kill kill_process "$work/softfocus" "${render[@]}" --threads 1 -o farm.png
  cmp one.png farm.png || fail "the sharded accumulation has other bytes"
  # As few parts as there may be, another format, a file with a sidecar; after -- no options.
  "$program" "${render[@]}" --format npy -o one.dat
  "$farm" --tasks 1 --retries 0 -- "$program" render --output=farm.dat --format=npy \
    "${render[@]:2}" -- figures \
    2>"$work/said" || fail "one task: $(cat "$work/said")"
  cmp one.dat farm.dat && cmp one.dat.json farm.dat.json || fail "one task has other bytes"
  rm -f ./*.png ./*.dat ./*.json
}

sequence() {
  local i refocus=(refocus in_%02d.npy --method one-pass --blur-at-infinity 60 --frames 1..6)
  "$program" render figures --size 480x360 --method pinhole --frames 1..6 -o in_%02d.npy 2>/dev/null
  "$program" "${refocus[@]}" -o one_%02d.png 2>/dev/null
  farm_and_kill cancel_task "$work/softfocus" "${refocus[@]}" --threads 1 -o farm_%02d.png
  for i in 01 02 03 04 05 06; do
    cmp one_$i.png farm_$i.png || fail "frame $i of the sequence has other bytes"
  done
  # More tasks than frames, and nothing to do that is not done.
  "$farm" --tasks 4 --retries 0 -- "$program" render figures --size 32x32 --frames 1..2 \
    -o few_%d.png 2>"$work/said" || fail "more tasks than frames: $(cat "$work/said")"
  [ -e few_1.png ] && [ -e few_2.png ] || fail "more tasks than frames: there are $(ls few_*)"
  rm -f ./*
}

# A task that fails and stays so: its reason, its log's place, and no more tasks than were asked for.
hopeless() {
  local said=$work/said
  cat >"$work/broken" <<END
#!/bin/bash
echo run >>"$work/runs"
echo 'softfocus: the moon is full' >&2
exit 1
END
  chmod +x "$work/broken"
  "$farm" --tasks 2 --retries 1 -- "$work/broken" render figures -o a.png 2>"$said" &&
    fail "broken tasks succeed"
  grep -q '^tools/farm: task 1 of 2 failed: softfocus: the moon is full$' "$said" &&
    grep -q '^tools/farm: 2 of 2 tasks failed; their logs are in /' "$said" ||
    fail "broken tasks: $(cat "$said")"
  [ "$(wc -l <"$work/runs")" -eq 4 ] || fail "broken tasks ran $(wc -l <"$work/runs") times, not 4"
  [ -e softfocus-farm-*/1.log ] || fail "broken tasks leave no log"
  rm -rf softfocus-farm-* "$work/runs"
  # Wrong usage is not tried again.
  "$farm" --tasks 2 -- "$program" render figures --method two-pass -o a.png 2>"$said"
  [ $? -eq 1 ] && ! grep -q 'run again' "$said" &&
    grep -q '^tools/farm: task 1 of 2 failed: softfocus: --shard: ' "$said" ||
    fail "wrong usage: $(cat "$said")"
  rm -rf softfocus-farm-*
}

interrupted() {
  cat >"$work/sleeper" <<END
#!/bin/bash
sleep 60
END
  chmod +x "$work/sleeper"
  "$farm" --tasks 2 -- "$work/sleeper" render figures -o a.png 2>"$work/said" &
  local farm_pid=$!
  for _ in $(seq 100); do
    [ -z "$(squeue --noheader --states=RUNNING)" ] || break
    sleep 0.1
  done
  kill -TERM $farm_pid
  wait $farm_pid
  [ $? -eq 130 ] && [ -z "$(ls)" ] || fail "an interrupt: $(cat "$work/said"), left $(ls)"
  for _ in $(seq 100); do
    [ -n "$(squeue --noheader)" ] || return 0
    sleep 0.1
  done
  fail "an interrupt leaves tasks: $(squeue)"
}

mkdir "$work/folder with 100% blanks" && cd "$work/folder with 100% blanks" || exit 1
wrong_usage
make_stopping_program
if start_daemons; then
  accumulation
  sequence
  hopeless
  interrupted
else
  fail "Slurm does not start"
fi
exit $failed
