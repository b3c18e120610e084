# A Slurm of two nodes on this machine, for a test: its own keys, ports, folders and processes, all
# on 127.0.0.1. To be sourced; needs bash. cluster_begin FOLDER, cluster_end.
# shellcheck shell=bash

# Debian keeps the daemons where a user's path does not lead
PATH=$PATH:/usr/sbin:/sbin
CLUSTER_WAIT=30 # s for a daemon to answer: some 1 s on two free cores

# A port from which on three are free.
cluster_port() {
    local port=$((20000 + $$ % 20000))
    while cut -c 1-32 /proc/net/tcp | grep -qiE "$(printf ':(%04X|%04X|%04X) ' \
        $port $((port + 1)) $((port + 2)))"; do
        port=$((port + 3))
    done
    echo $port
}

# cred_expire is also what a job waits for in the queue when it is put back: 120 s unless told
# otherwise, 5 s at least. SlurmdTimeout is what a silent node is waited for.
cluster_configure() {
    local folder=$1 port host user
    port=$(cluster_port)
    host=$(hostname -s)
    user=$(id -un)
    cat >"$folder/slurm.conf" <<CONF
ClusterName=jointplay
SlurmctldHost=$host(127.0.0.1)
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$folder/munge.sock,cred_expire=5
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
SlurmctldPort=$port
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd-%n.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd-%n.log
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool-%n
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,bf_interval=1,batch_sched_delay=0
MailProg=/bin/true
ReturnToService=2
KillWait=5
SlurmdTimeout=30
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=1 RealMemory=500
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=1 RealMemory=500
PartitionName=main Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
CONF
}

cluster_node_begin() {
    slurmd -N "$1" -f "$SLURM_CONF"
}

# Whether so many nodes are free within a while.
cluster_await_nodes() {
    local end=$((SECONDS + CLUSTER_WAIT))
    while [ "$(sinfo --noheader --Node --states=idle 2>/dev/null | wc -l)" != "$1" ]; do
        [ $SECONDS -lt $end ] || return 1
        sleep 0.1
    done
}

cluster_begin() {
    CLUSTER=$1
    mkdir -p "$CLUSTER/state" "$CLUSTER/spool-n1" "$CLUSTER/spool-n2"
    chmod 700 "$CLUSTER"
    cluster_configure "$CLUSTER"
    export SLURM_CONF=$CLUSTER/slurm.conf
    (umask 077 && head -c 1024 /dev/urandom >"$CLUSTER/munge.key")
    munged --force --key-file="$CLUSTER/munge.key" --socket="$CLUSTER/munge.sock" \
        --log-file="$CLUSTER/munged.log" --pid-file="$CLUSTER/munged.pid" \
        --seed-file="$CLUSTER/munge.seed" &&
        slurmctld -f "$SLURM_CONF" &&
        cluster_node_begin n1 && cluster_node_begin n2 && cluster_await_nodes 2
}

# The number of the process that started another; ps puts blanks before a short one.
cluster_parent() {
    ps -o ppid= -p "$1" | tr -d ' '
}

# A process and all that it has started.
cluster_tree() {
    local child
    for child in $(ps -o pid= --ppid "$1"); do
        cluster_tree "$child"
    done
    echo "$1"
}

# A daemon by its name, and what it has started; once, for the number may then be another's.
cluster_daemon_kill() {
    local file=$CLUSTER/$1.pid
    [ ! -s "$file" ] || cluster_tree "$(cat "$file")" | xargs -r kill -9 2>/dev/null
    rm -f "$file"
    return 0
}

# Ends everything on a node at once, as a power cut does: its daemon and what the jobs there began.
cluster_node_kill() {
    local script keeper socket job
    cluster_daemon_kill "slurmd-$1"
    for script in $(pgrep -f "^/bin/bash $CLUSTER/spool-$1/"); do
        # the keeper of a job is the parent of its script, and stands above all of it; a child that
        # bash has forked from the script looks like it
        keeper=$(cluster_parent "$script")
        [ "$(ps -o comm= -p "${keeper:-0}")" != slurmstepd ] ||
            cluster_tree "$keeper" | xargs -r kill -9
    done 2>/dev/null
    # a keeper whose script was not seen is known by the socket of its job: one that outlived its
    # node would end the next try of the job together with itself
    for socket in "$CLUSTER/spool-$1/$1_"*; do
        job=${socket##*_}
        for keeper in $(pgrep -f "^slurmstepd: \\[${job%%.*}\\."); do
            cluster_tree "$keeper" | xargs -r kill -9
        done
    done 2>/dev/null
    # a process that was gone before its turn came is no failure
    return 0
}

# Whether the queue is empty within so many seconds.
cluster_await_jobs() {
    local end=$((SECONDS + $1))
    while [ -n "$(squeue --noheader)" ]; do
        [ $SECONDS -lt $end ] || return 1
        sleep 0.2
    done
}

# Ends every process of the cluster; nothing of it is left.
cluster_end() {
    cluster_node_kill n1
    cluster_node_kill n2
    cluster_daemon_kill slurmctld
    cluster_daemon_kill munged
}
